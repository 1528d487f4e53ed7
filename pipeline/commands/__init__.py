"""The commands of `symolo`: one file for each command, named after it, or for a group such as `symolo effect`.

`make/` has the commands that make data, `datasets/` those for datasets that exist, `measured/` those for measured data,
and `machine/` the others. `import` and `next` are in `import_logs.py` and `next_trial.py`, because Python has these
words itself. What several commands share is beside this file: `options.py` declares their options. A command imports
what it needs when it is called, so that `symolo --help` is quick.
"""
