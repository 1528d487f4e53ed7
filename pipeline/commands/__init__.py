"""The commands of `symolo`: one file for each command, or for a group of commands that belong together.

`options.py` declares the options that several commands share. A command imports what it needs when it is called, so
that `symolo --help` is quick.
"""
