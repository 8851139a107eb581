"""The nonlinear rod: a chain of rigid bodies on SE(3), moved by a symplectic integrator."""
