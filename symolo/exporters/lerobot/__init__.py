"""Format of LeRobot: episodes in Parquet files, their statistics, and images as files or videos."""
