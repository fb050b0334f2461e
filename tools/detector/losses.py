"""How wrong the network is.

- Scores: the quality focal loss of Li et al., Generalized Focal Loss, NeurIPS 2020. The score to be
  given is the root of the box's own IoU with the thing, so that the surest box is the best one.
- Boxes: 1 - GIoU, Rezatofighi et al., Generalized Intersection over Union, CVPR 2019.
"""

from typing import Tuple

import torch
from torch.nn.functional import binary_cross_entropy_with_logits

BOX_WEIGHT = 2.0


def overlaps(a: torch.Tensor, b: torch.Tensor) -> Tuple[torch.Tensor, torch.Tensor]:
    """IoU and GIoU (n,) of boxes (n, 4), x0, y0, x1, y1, one to one."""
    tiny = 1e-6
    common = (torch.min(a[:, 2:], b[:, 2:]) - torch.max(a[:, :2], b[:, :2])).clamp(min=0).prod(1)
    areas = [(box[:, 2:] - box[:, :2]).prod(1) for box in (a, b)]
    union = areas[0] + areas[1] - common + tiny
    hull = (torch.max(a[:, 2:], b[:, 2:]) - torch.min(a[:, :2], b[:, :2])).prod(1) + tiny
    iou = common / union
    return iou, iou - (hull - union) / hull


def corners(boxes: torch.Tensor) -> torch.Tensor:
    """(..., 4) boxes cx, cy, width, height as x0, y0, x1, y1."""
    middle, half = boxes[..., :2], boxes[..., 2:] / 2
    return torch.cat([middle - half, middle + half], -1)


def loss_of(
    boxes: torch.Tensor,
    scores: torch.Tensor,
    classes: torch.Tensor,
    target_boxes: torch.Tensor,
    unclear: torch.Tensor,
) -> torch.Tensor:
    """The loss of a batch: the network's two outputs, and the fields of its targets."""
    boxes, scores = corners(boxes.transpose(1, 2)), scores.transpose(1, 2)
    found = classes >= 0
    count = max(int(found.sum()), 1)
    iou, giou = overlaps(boxes[found], target_boxes[found])

    wanted = torch.zeros_like(scores)
    numbers = torch.nonzero(found, as_tuple=True)
    wanted[numbers[0], numbers[1], classes[found]] = iou.detach().clamp(min=0).sqrt()
    surprise = (scores.sigmoid() - wanted).abs() ** 2
    each = binary_cross_entropy_with_logits(scores, wanted, reduction="none") * surprise
    of_scores = (each * ~(unclear & (wanted == 0))).sum() / count
    return of_scores + BOX_WEIGHT * (1 - giou).sum() / count
