"""Where units of work are done. One protocol, one file for each kind; the same bytes come of each."""
