"""Six-axis robots: description, kinematics, inverse kinematics, configurations and branch choice."""
