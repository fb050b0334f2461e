"""The names of the classes of two data sets that most public models were trained with.

COCO (https://cocodataset.org) has 80 classes, whose numbers in its own files go from 1 to 90 with
gaps; some models count as it does, others without the gaps. PASCAL VOC
(http://host.robots.ox.ac.uk/pascal/VOC) has 20.
"""

from typing import Dict, List

_COCO = (
    "person,bicycle,car,motorcycle,airplane,bus,train,truck,boat,traffic light,fire hydrant,"
    "stop sign,parking meter,bench,bird,cat,dog,horse,sheep,cow,elephant,bear,zebra,giraffe,"
    "backpack,umbrella,handbag,tie,suitcase,frisbee,skis,snowboard,sports ball,kite,baseball bat,"
    "baseball glove,skateboard,surfboard,tennis racket,bottle,wine glass,cup,fork,knife,spoon,bowl,"
    "banana,apple,sandwich,orange,broccoli,carrot,hot dog,pizza,donut,cake,chair,couch,"
    "potted plant,bed,dining table,toilet,tv,laptop,mouse,remote,keyboard,cell phone,microwave,"
    "oven,toaster,sink,refrigerator,book,clock,vase,scissors,teddy bear,hair drier,toothbrush"
)
COCO = _COCO.split(",")
COCO_GAPS = (12, 26, 29, 30, 45, 66, 68, 69, 71, 83)  # numbers of its files that are no class
_VOC = (
    "aeroplane,bicycle,bird,boat,bottle,bus,car,cat,chair,cow,diningtable,dog,horse,motorbike,"
    "person,pottedplant,sheep,sofa,train,tvmonitor"
)
VOC = _VOC.split(",")


def _with_gaps() -> List[str]:
    """Returns the names of the numbers 0 to 90 of COCO's files."""
    names = iter(COCO)
    gaps = (0, *COCO_GAPS)
    return [f"class {number}" if number in gaps else next(names) for number in range(91)]


# By the word of the parameter, the lists that it may stand for; their lengths tell which.
KNOWN_NAMES: Dict[str, List[List[str]]] = {
    "coco": [COCO, _with_gaps()[1:], _with_gaps()],
    "voc": [VOC],
}
