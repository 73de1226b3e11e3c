"""Cross products as matrices, and frames about an axis."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from armodal.analyzer.screws.cross import across, skew

vectors = arrays(np.float64, 3, elements=st.floats(-1, 1))


@given(vectors, vectors)
def test_the_matrix_of_a_vector_gives_its_cross_products(v, w):
    np.testing.assert_allclose(skew(v) @ w, np.cross(v, w), atol=1e-15)
    np.testing.assert_allclose(skew(np.array([v, w]))[1] @ v, np.cross(w, v), atol=1e-15)


@given(vectors)
def test_a_frame_completes_a_direction_to_an_orthogonal_one(v):
    length = np.linalg.norm(v)
    if length < 1e-3:
        return
    direction = v / length
    frame = np.column_stack([across(direction), direction])
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-13)
