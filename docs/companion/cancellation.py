"""Prints how often formulas of chapter G confuse hit and miss, as shares of 1."""
import numpy as np

def dot(a, b):
    return (a * b).sum(axis=1)

def unit(v):
    return v / np.sqrt(dot(v, v))[:, None]

def book(d, f, r):
    return dot(d, f) ** 2 - dot(d, d) * (dot(f, f) - r * r) >= 0

def perpendicular(d, f, r):
    l = f - (dot(d, f) / dot(d, d))[:, None] * d
    return r * r - dot(l, l) >= 0

n, rng = 1_000_000, np.random.default_rng(1)
for distance in (10, 100, 1_000, 10_000, 100_000):
    d = unit(rng.normal(size=(n, 3)))
    across = unit(np.cross(d, rng.normal(size=(n, 3))))
    f = distance * d + np.sqrt(rng.random(n))[:, None] * across    # centre - origin
    single = d.astype(np.float32), f.astype(np.float32), np.float32(0.5)
    double = single[0].astype(float), single[1].astype(float), 0.5
    right = perpendicular(*double)
    for hit in (book(*single), perpendicular(*single), book(*double)):
        print(distance, np.mean(hit != right))
