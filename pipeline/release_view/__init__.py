"""A page that shows a release while it is made: how far it is, and the last image with its place on the map."""
