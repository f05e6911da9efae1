"""Material points that their particles carry: probes, and the outline of a body.

x = x_p + sum_k w_k (x_k - x_p) + rest,   w_k = d_k . M^-1 s,   M = sum_k d_k d_k^T,   d_k = X_k - X_p,   s = X - X_p
p is the point's particle, k its neighbours at the start. That is x_p + F s with the deformation gradient F that fits the neighbours best (least squares):
exact in every affine motion, of second order in the distance otherwise. `rest` is what of s no neighbour spans (a layer of one particle): it does not turn.
A field of the particles at the point is, alike, theta_p + sum_k w_k (theta_k - theta_p) + c_p . rest: linear fields are exact, however the body is turned
and stretched.
Fails when   neighbours have parted (torn, poured): then F is theirs, not the material's. `reach` bounds what is claimed.
"""

from typing import NamedTuple

import numpy as np

THIN = 1e-6  # of the largest: an eigenvalue of M below this is no direction


class Carried(NamedTuple):
    """S material points of one body, K neighbours each. A neighbour that is not there is the particle itself, at weight zero."""

    owner: np.ndarray  # (S,) particle
    near: np.ndarray  # (S, K) neighbours
    weight: np.ndarray  # (S, K) [-]
    rest: np.ndarray  # (S, D) [m]


def carried(x: np.ndarray, owner: np.ndarray, offset: np.ndarray, near: np.ndarray) -> Carried:
    """Points at x[owner] + offset. x (N, D) at the start; owner (S,), offset (S, D), near (S, K)."""
    d = x[near] - x[owner][:, None]
    M = np.einsum("ski,skj->sij", d, d)
    weight = np.einsum("ski,sij,sj->sk", d, np.linalg.pinv(M, rcond=THIN, hermitian=True), offset)
    return Carried(owner, near, weight, offset - np.einsum("sk,ski->si", weight, d))


def nearest(x: np.ndarray, point: np.ndarray) -> Carried:
    """One point, carried by the nearest particle and the 3^D - 1 nearest to that."""
    owner = int(np.argmin(np.sum((x - point) ** 2, axis=1)))
    order = np.argsort(np.sum((x - x[owner]) ** 2, axis=1), kind="stable")
    near = order[order != owner][: 3 ** x.shape[1] - 1]
    return carried(x, np.array([owner]), (point - x[owner])[None], near[None])


def moved(points: Carried, x: np.ndarray, reach: float = np.inf) -> np.ndarray:
    """Where the points are now (S, D), none farther than `reach` [m] from its particle. x (N, D): positions of the particles."""
    here = x[points.owner].astype(float)
    arm = np.einsum("sk,ski->si", points.weight, x[points.near] - here[:, None]) + points.rest
    length = np.linalg.norm(arm, axis=1, keepdims=True)
    return here + arm * np.minimum(1.0, reach / np.maximum(length, 1e-300))


def sampled(points: Carried, theta: np.ndarray, c: np.ndarray) -> np.ndarray:
    """A field at the points (S,) from its values theta (N,) and slopes c (N, D) at the particles."""
    here = theta[points.owner].astype(float)
    return here + np.sum(points.weight * (theta[points.near] - here[:, None]), axis=1) + np.sum(c[points.owner] * points.rest, axis=1)


def renumbered(points: Carried, place: np.ndarray | None) -> Carried:
    """The same points where particle i stands at place[i] now; None: where it was."""
    return points if place is None else points._replace(owner=place[points.owner], near=place[points.near])
