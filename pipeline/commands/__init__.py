"""The commands of `symolo`, by what they are for; each loads what it needs when it is called."""
