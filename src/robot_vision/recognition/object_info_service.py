"""The service get_object_info, which tells what the database knows of an object."""

from typing import Any, List

import rospy

from ..common.plain_text import printable
from ..msg import ObjectInformation
from ..ros.context import current
from ..srv import GetObjectInformation, GetObjectInformationResponse
from .database import Database
from .mesh_data import unpack_mesh
from .recognition_messages import information


class ObjectInfoService:
    """Serves it under one or more names.

    Args:
        names: The names.
        path: That of the database.
    """

    def __init__(self, names: List[str], path: str) -> None:
        self._path = path
        for name in names:
            current().service(name, GetObjectInformation, self._on_call)

    def _on_call(self, request: Any) -> GetObjectInformationResponse:
        try:
            with Database(self._path) as database:
                one = database.objects.find(request.type.key)
                if database.meshes.entry(one.id) is None:
                    made = ObjectInformation(name=one.name)
                else:
                    mesh = unpack_mesh(database.meshes.converted(one.id))
                    made = information(one.name, mesh)
        except (OSError, ValueError) as error:
            reason = printable(str(error), 1000)
            rospy.logerr("no information on an object: %s", reason)
            raise rospy.ServiceException(reason) from None
        return GetObjectInformationResponse(made)
