"""The camera: projection, shutter, lens and the response from light to pixel values."""
