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
    asked = points(4000, 4)
    in_box = (np.abs(asked) < 2).all(axis=1)
    np.testing.assert_allclose(winding_numbers(fine_box((-2, -2, -2), (2, 2, 2), 6), asked), in_box, atol=0.06)
    np.testing.assert_allclose(winding_numbers(fine_box((-2, -2, -2), (2, 2, 2), 6), asked, np.inf), in_box, atol=1e-9)
    radii = np.linalg.norm(asked, axis=1)
    clear = (radii < 2.9) | (radii > 3)  # between them the flat triangles cut
    winding = winding_numbers(sphere(3, rings=24), asked)
    assert ((winding[clear] > 0.5) == (radii[clear] < 3)).all()


def test_overlaps_add_and_flipped_ones_take_away():
    asked = np.array([[0.5, 0.5, 0.5], [1.5, 0.5, 0.5], [5.0, 0.0, 0.0]])
    one, two = box((0, 0, 0), (2, 1, 1)), box((1, 0, 0), (3, 1, 1))
    np.testing.assert_allclose(winding_numbers(joined(one, two), asked), [1, 2, 0], atol=1e-9)
    np.testing.assert_allclose(winding_numbers(turned(one), asked), [-1, -1, 0], atol=1e-9)


def test_a_hole_blurs_only_what_is_near():
    shape = fine_box((-2, -2, -2), (2, 2, 2), 6)
    holed = Surface(shape.vertices, np.delete(shape.triangles, [10, 11, 12], axis=0))
    asked = points(2000, 1.5)
    assert (winding_numbers(holed, asked) > 0.5).all()


def test_distances_from_a_box():
    asked = points(3000, 5)
    outside = np.linalg.norm(np.maximum(np.abs(asked) - 2, 0), axis=1)
    inside = 2 - np.abs(asked).max(axis=1)
    exact = np.where(inside > 0, inside, outside)
    np.testing.assert_allclose(distances(fine_box((-2, -2, -2), (2, 2, 2), 5).corners, asked), exact, atol=1e-12)
    assert distances(box((0, 0, 0), (1, 1, 1)).corners, np.array([[2.0, 2.0, 0.5]]))[0] == pytest.approx(np.sqrt(2))
