"""Output of a diagnosis for people: sentences, tables, plots and one page, all from the same results."""
