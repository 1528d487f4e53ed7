"""Images and skies of the user: named in a look, identified by their content, read by one decoder."""
