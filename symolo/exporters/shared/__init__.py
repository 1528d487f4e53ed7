"""What several formats share: splits, stereo pairs, records of images, typed columns and cards."""
