"""Objects without a mesh: looked at on a turntable of tags, and put together from their depths."""
