# SPDX-FileCopyrightText: 2026 the trunnion authors
# SPDX-License-Identifier: BSD-3-Clause
"""ns per sample of the compiled core of python-ins, on the coning increments of strapdown_benchmark.cpp: best of five."""
import time

import numpy as np
from pyins._numba_integrate import integrate

n, h, a, w = 10**6, 1 / 400, np.deg2rad(1), 2 * np.pi * 10
m = w * h * (np.arange(n) + 0.5)
one = np.ones(n)
across = 2 * np.sin(a) * np.sin(0.5 * w * h)
theta = np.c_[-2 * w * np.sin(a / 2) ** 2 * h * one, -across * np.sin(m), across * np.cos(m)]
dv = np.c_[0.1 * h * np.sin(m), 0.1 * h * np.cos(m), -9.8 * h * one]


def run():
    lla, velocity, attitude = np.zeros((n + 1, 3)), np.zeros((n + 1, 3)), np.zeros((n + 1, 3, 3))
    lla[0], attitude[0] = (45.8, 0, 100), np.eye(3)
    start = time.perf_counter()
    integrate(np.full(n, h), lla, velocity, attitude, theta, dv, 0, True)
    return (time.perf_counter() - start) / n * 1e9


run()  # compilation
print(f"{min(run() for _ in range(5)):.1f} ns/sample")
