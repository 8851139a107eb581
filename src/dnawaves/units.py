"""Unit conversions, all in one place.

Inside the library: nm, ps, Da, kJ/mol, rad (1 kJ/mol = 1 Da nm^2/ps^2).
At boundaries (files, reports): the unit is part of the name.
Constants: CODATA 2018.
"""

from __future__ import annotations

import math

KG_PER_DA = 1.66053906660e-27
BOLTZMANN_KJ_PER_MOL_K = 8.31446261815324e-3
A_PER_NM = 10.0
GHZ_PER_RAD_PER_PS = 1e3 / (2 * math.pi)

# One kJ/mol/nm = 1 Da nm/ps^2, in piconewton.
PN_PER_KJ_PER_MOL_NM = KG_PER_DA * 1e-9 / 1e-24 * 1e12

# The same number: one pN nm in kJ/mol, or one pN in kJ/mol/nm.
KJ_PER_MOL_PER_PN_NM = 1 / PN_PER_KJ_PER_MOL_NM

# SI to internal units, for rod constants.
DA_PER_NM_PER_KG_PER_M = 1e-9 / KG_PER_DA
DA_NM_PER_KG_M = 1e9 / KG_PER_DA
KJ_PER_MOL_NM_PER_N = 1e12 / PN_PER_KJ_PER_MOL_NM
KJ_NM_PER_MOL_PER_N_M2 = KJ_PER_MOL_NM_PER_N * 1e18
