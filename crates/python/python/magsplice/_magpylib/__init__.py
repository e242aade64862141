"""Cuboids of magpylib: their fields in magpylib's units and shapes, and collections of films."""
