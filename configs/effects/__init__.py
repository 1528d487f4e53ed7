"""What an effect is, which effects there are, and the effects of one robot."""
