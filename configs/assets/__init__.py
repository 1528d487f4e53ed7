"""The user's own pictures and skies: named in a look, known by their content, copied once, read by one decoder."""
