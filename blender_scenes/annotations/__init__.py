"""Exact annotations of images: masks, depth, normals, flow, boxes and key points, as functions of a `VisibleScene`."""
