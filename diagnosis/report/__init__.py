"""What a diagnosis says to people: sentences, tables, pictures and one page, all from the same findings."""
