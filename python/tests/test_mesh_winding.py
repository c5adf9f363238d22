"""Winding numbers and distances against what is known exactly."""

import numpy as np
import pytest
from mesh_shapes import box, fine_box, joined, sphere, turned

from softkin.mesh.distance import distances
from softkin.mesh.surface import Surface
from softkin.mesh.winding import winding_numbers


def points(count, size):
    return np.random.default_rng(0).uniform(-size, size, (count, 3))


def test_a_box_and_a_sphere():
    requested = points(4000, 4)
    in_box = (np.abs(requested) < 2).all(axis=1)
    np.testing.assert_allclose(winding_numbers(fine_box((-2, -2, -2), (2, 2, 2), 6), requested), in_box, atol=0.06)
    np.testing.assert_allclose(winding_numbers(fine_box((-2, -2, -2), (2, 2, 2), 6), requested, np.inf), in_box, atol=1e-9)
    radii = np.linalg.norm(requested, axis=1)
    clear = (radii < 2.9) | (radii > 3)  # between them the flat triangles cut
    winding = winding_numbers(sphere(3, rings=24), requested)
    assert ((winding[clear] > 0.5) == (radii[clear] < 3)).all()


def test_overlaps_add_and_flipped_ones_take_away():
    requested = np.array([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [5.0, 0.0, 0.0]])
    one, two = box((0, 0, 0), (2, 1, 1)), box((1, 0, 0), (3, 1, 1))
    np.testing.assert_allclose(winding_numbers(joined(one, two), requested), [1, 2, 0], atol=1e-9)
    np.testing.assert_allclose(winding_numbers(turned(one), requested), [-1, -1, 0], atol=1e-9)


def test_a_hole_blurs_only_what_is_near():
    shape = fine_box((-2, -2, -2), (2, 2, 2), 6)
    holed = Surface(shape.vertices, np.delete(shape.triangles, [10, 11, 12], axis=0))
    requested = points(2000, 1.5)
    assert (winding_numbers(holed, requested) > 0.5).all()


def test_distances_from_a_box():
    requested = points(3000, 5)
    outside = np.linalg.norm(np.maximum(np.abs(requested) - 2, 0), axis=1)
    inside = 2 - np.abs(requested).max(axis=1)
    exact = np.where(inside > 0, inside, outside)
    np.testing.assert_allclose(distances(fine_box((-2, -2, -2), (2, 2, 2), 5).corners, requested), exact, atol=1e-12)
    assert distances(box((0, 0, 0), (1, 1, 1)).corners, np.array([[2.0, 2.0, 0.5]]))[0] == pytest.approx(np.sqrt(2))
