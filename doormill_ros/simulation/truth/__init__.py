"""Physics of the simulated truth: kinematics, effects and elasticity of a robot nobody modelled."""
