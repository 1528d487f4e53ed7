"""What is measured in the images: edges, levels, sharpness and noise."""
