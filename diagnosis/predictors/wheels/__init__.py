"""The stage that predicts the speeds of both wheels of a drive, and what disturbs these speeds."""
