"""Training of the network in config/networks, which finds the things of the synthetic scenes.

It is no part of what is installed. Only network, losses, dataset, training, export and train need
PyTorch. The others make frames, and judge what is found in them.
"""
