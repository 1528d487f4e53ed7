"""Commands for datasets that exist: show, check, keep complete, sign, convert and share them."""
