"""What accuracy costs: settings of a simulation, their error against a known answer, their time."""
