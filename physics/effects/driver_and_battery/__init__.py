"""Effects on the voltage and current that the motors get: command, driver, supply and battery."""
