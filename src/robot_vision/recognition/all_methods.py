"""Makes all methods known that learn objects."""

from . import pair_method, texture_method, view_method

__all__ = ["pair_method", "texture_method", "view_method"]
