"""Parts of the nodes of cameras and other sensors: triggered by a request, told as poses."""
