"""Parts of the fault campaign: scenarios, world, robot and bridge processes, network faults, judge."""
