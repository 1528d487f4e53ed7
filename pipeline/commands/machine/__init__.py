"""Commands about this machine and about what symolo reads and prints: doctor, schema."""
