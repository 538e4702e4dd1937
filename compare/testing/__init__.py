"""For tests of engines: the pytest plugin, tolerances with a reason, golden runs, strategies of hypothesis."""
