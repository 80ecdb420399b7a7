"""What a call costs in Python: see ../cost.c. Prints a line of the table."""

import time

import numpy as np
import tribo

COUNT, ALONE, ROUNDS = 10_000, 500, 200  # few calls a round: the least is then one without others
MASK = 2**64 - 1
state = 1


def unit():
    global state
    state = state + 0x9E3779B97F4A7C15 & MASK
    z = state
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9 & MASK
    z = (z ^ z >> 27) * 0x94D049BB133111EB & MASK
    z ^= z >> 31
    return (z >> 11) * 2.0**-53


def least(call, count):
    best = float("inf")
    for _ in range(ROUNDS):
        start = time.perf_counter_ns()
        call()
        best = min(best, time.perf_counter_ns() - start)
    return best / count


w, b, mu = np.zeros((COUNT, 6)), np.zeros((COUNT, 3)), np.zeros((COUNT, 2))
for k in range(COUNT):
    for i in range(6):
        side = 2.0 * unit() - 1.0
        w[k, i] = 2.0 + side if i in (0, 3, 5) else 0.5 * side
    b[k] = [2.0 * unit() - 1.0 for _ in range(3)]
    mu[k, 0] = 2.0 * unit()
    mu[k, 1] = unit() * mu[k, 0]
    unit()

contacts = []
for k in range(ALONE):
    contact = tribo.Contact()
    contact.w[:], contact.b[:], contact.mu[:] = w[k], b[k], mu[k]
    contacts.append(contact)


def alone():
    for contact in contacts:
        contact.solve()


p, modes = np.zeros((COUNT, 3)), np.zeros(COUNT, np.uint32)
batch = least(lambda: tribo.batch_solve(w, b, mu, p, modes), COUNT)
print(f"Python\t{least(alone, ALONE):.1f}\t{batch:.1f}")
