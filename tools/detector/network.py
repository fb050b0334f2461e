"""The network: a small one-stage detector without anchors, of plain 3x3 convolutions.

All that is in it can be read by the ONNX importers of OpenCV 4.2 and later: convolutions also to
larger images, ReLU, sigmoid, sums and products, reshaping. Plain convolutions are used because
cv2.dnn is several times slower, for the same number of operations, with depthwise ones.
"""

from typing import List, Tuple

import numpy as np
import torch
from torch import nn

from .targets import POINT_STRIDES, POINTS, STRIDES
from .things import NAMES

REACH = 8.0  # strides from a point to the farthest side of a box
NECK = 40  # channels
RARE = 0.01  # score of everything before the training begins


class Block(nn.Sequential):
    """A convolution, its normalisation and ReLU."""

    def __init__(self, inputs: int, outputs: int, kernel: int = 3, stride: int = 1):
        super().__init__(
            nn.Conv2d(inputs, outputs, kernel, stride, kernel // 2, bias=False),
            nn.BatchNorm2d(outputs, momentum=0.03),
            nn.ReLU(),
        )


class Residual(nn.Module):
    """A block whose input is added to its output."""

    def __init__(self, channels: int):
        super().__init__()
        self.block = Block(channels, channels)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x + self.block(x)


class Head(nn.Module):
    """What the points of one grid say: the sides of a box, and a score for each class."""

    def __init__(self, stride: int):
        super().__init__()
        self.count = int(np.sum(stride == POINT_STRIDES))
        self.block = Block(NECK, NECK)
        self.sides = nn.Conv2d(NECK, 4, 1)
        self.scores = nn.Conv2d(NECK, len(NAMES), 1)
        nn.init.constant_(self.scores.bias, float(np.log(RARE / (1 - RARE))))
        nn.init.constant_(self.sides.bias, -0.5)
        # From the distances of the left, upper, right and lower side, which are up to 1, to how far
        # the middle is from the point, width and height, px.
        rows = [[-0.5, 0, 0.5, 0], [0, -0.5, 0, 0.5], [1, 0, 1, 0], [0, 1, 0, 1]]
        weights = REACH * stride * torch.tensor(rows)
        self.register_buffer("to_box", weights[:, :, None, None], persistent=False)

    def forward(self, x: torch.Tensor) -> Tuple[torch.Tensor, torch.Tensor]:
        features = self.block(x)
        share = torch.sigmoid(self.sides(features))
        boxes = nn.functional.conv2d(share * share, self.to_box)
        scores = self.scores(features)
        return boxes.reshape(-1, 4, self.count), scores.reshape(-1, len(NAMES), self.count)


class SceneNetwork(nn.Module):
    """From images (b, 3, height, width), RGB of 0 to 1, to boxes and classes of n points."""

    def __init__(self) -> None:
        super().__init__()
        self.fine = nn.Sequential(
            Block(3, 8, stride=2),
            Block(8, 16, stride=2),
            Residual(16),
            Block(16, 32, stride=2),
            Residual(32),
            Residual(32),
        )
        self.middle = nn.Sequential(Block(32, 56, stride=2), Residual(56))
        self.coarse = nn.Sequential(Block(56, 64, stride=2), Residual(64))
        self.lateral = nn.ModuleList([Block(c, NECK, kernel=1) for c in (32, 56, 64)])
        self.merge = nn.ModuleList([Block(NECK, NECK) for _ in range(2)])
        self.larger = nn.ModuleList([nn.ConvTranspose2d(NECK, NECK, 2, 2) for _ in range(2)])
        self.heads = nn.ModuleList([Head(stride) for stride in STRIDES])
        middles = np.zeros((1, 4, len(POINTS)), np.float32)
        middles[0, :2] = POINTS.T
        self.register_buffer("middles", torch.from_numpy(middles), persistent=False)

    def grids(self, images: torch.Tensor) -> List[torch.Tensor]:
        """Features for each grid: each knows what the coarser ones have seen."""
        fine = self.fine(images)
        middle = self.middle(fine)
        coarse = self.lateral[2](self.coarse(middle))
        middle = self.merge[1](self.lateral[1](middle) + self.larger[1](coarse))
        fine = self.merge[0](self.lateral[0](fine) + self.larger[0](middle))
        return [fine, middle, coarse]

    def forward(self, images: torch.Tensor) -> Tuple[torch.Tensor, torch.Tensor]:
        """Boxes (b, 4, n), px cx, cy, width, height, and (b, classes, n) scores before sigmoid."""
        said = [head(grid) for head, grid in zip(self.heads, self.grids(images))]
        boxes, scores = (torch.cat(parts, 2) for parts in zip(*said))
        return boxes + self.middles, scores


class ExportedNetwork(nn.Module):
    """The same with one output as that of YOLOv8: (b, 4 + classes, n), scores of 0 to 1."""

    def __init__(self, network: SceneNetwork):
        super().__init__()
        self.network = network

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        boxes, scores = self.network(images)
        return torch.cat([boxes, torch.sigmoid(scores)], 1)
