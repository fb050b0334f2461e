"""Training objects of a database: those that need it, and interrupted ones from where they were.

What a model is made of has a hash, its key: mesh and symmetries, or observations, parameters, and
the method with its version. What has the same key has the same model, to the bit.
"""

import hashlib
import json
import time
from typing import Any, Dict, Mapping, NamedTuple, Optional

from ..common.errors import about
from ..common.plain_text import printable
from .database import Database, Model, Object
from .database.blobs import digest_of
from .database.connection import BusyError
from .database.meshes import MeshEntry, to_json
from .methods import Method, ObservingMethod, Trainer
from .observed_views import ObservationSource
from .training_progress import TrainingProgress

SAVE_PERIOD = 30.0  # s between two times that an unfinished training is stored


class Task(NamedTuple):
    """An object to train, by a method with parameters.

    Attributes:
        mesh: Its mesh; None: it is learned by observations.
        observed: The hash of these, or "".
    """

    object: Object
    mesh: Optional[MeshEntry]
    observed: str
    method: Method
    parameters: Dict[str, Any]

    @property
    def title(self) -> str:
        return title_of(self.object, self.method)

    @property
    def key(self) -> str:
        """The hash of all that the model is made of."""
        if self.mesh is None:
            source: Dict[str, Any] = {"observations": self.observed}
        else:
            symmetries = to_json(self.mesh.symmetries)
            source = {"mesh": self.mesh.converted, "symmetries": symmetries}
        made_of = {
            **source,
            "method": self.method.name,
            "version": self.method.version,
            "parameters": self.parameters,
        }
        return hashlib.sha256(json.dumps(made_of, sort_keys=True).encode()).hexdigest()


def train(database: Database, task: Task, force: bool) -> bool:
    """Trains an object unless its model is as it would be; returns whether there is a new model.

    Ctrl-C stores what was done, and the next training goes on from there.

    Args:
        database: The database.
        task: The object and the method.
        force: Whether to train even if the model is there.

    Raises:
        OSError: The database cannot be written.
        ValueError: The object cannot be learned.
    """
    with about(task.title):
        key = task.key
        there = None if force else _made_of_the_same(database, task, key)
        if there is not None:
            return _adopt(database, task, there)
        trainer = _trainer(database, task, None if force else database.models.state(key))
        with TrainingProgress(task.title, trainer.done, trainer.total) as progress:
            _work(database, key, trainer, progress)
            _set(database, _model(task, key, trainer.model()), progress)
            progress.tell(f"{trainer.total} views learned")
    return True


def _set(database: Database, model: Model, progress: TrainingProgress) -> None:
    """Stores a model, when no other program writes any longer."""
    while True:
        try:
            with database.transaction():
                database.models.set(model)
            return
        except BusyError as error:
            progress.tell(f"the model is not stored yet: {error}")


def _made_of_the_same(database: Database, task: Task, key: str) -> Optional[Model]:
    """Returns the object's model, else another one's, of this key, unless it cannot be used."""
    own = database.models.entry(task.object.id, task.method.name)
    try:
        if own is not None and own.key == key:
            there = database.models.of(task.object.id, task.method.name)
        else:
            there = database.models.with_key(key)
        if there is not None:
            task.method.check_model(there.data)
        return there
    except ValueError as error:
        print(f"{task.title}: the model that is there is not used: {error}", flush=True)
        return None


def _adopt(database: Database, task: Task, there: Model) -> bool:
    """Takes a model that is made of the same, unless the object has it."""
    if there.object_id == task.object.id:
        print(
            f"{task.title}: nothing has changed, the model of {printable(there.added)} stays",
            flush=True,
        )
        return False
    with database.transaction():
        database.models.set(_model(task, there.key, there.data))
    print(f"{task.title}: the model of {printable(there.added)} is of the same mesh and parameters")
    return True


def _trainer(database: Database, task: Task, stored: Any) -> Trainer:
    """Returns a trainer that goes on from what was stored, if that can be used."""
    if task.mesh is None:
        source: Any = ObservationSource(database, task.object.id)
        begin: Any = task.method.trainer_of_observations
        is_same = database.observations.digest(task.object.id) == task.observed
    else:
        source, begin = database.meshes.of(task.object.id), task.method.trainer
        is_same = source is not None and (
            (digest_of(source.converted), list(source.symmetries))
            == (task.mesh.converted, task.mesh.symmetries)
        )
    if not is_same:  # Its model would get the key of what was there before.
        raise ValueError("what it is learned by was changed just now: train it again")
    if stored is not None:
        try:
            return begin(source, task.parameters, stored[1])
        except ValueError as error:
            print(f"{task.title}: what was done is not used: {error}", flush=True)
    return begin(source, task.parameters, None)


def _work(database: Database, key: str, trainer: Trainer, progress: TrainingProgress) -> None:
    saved = time.monotonic()
    try:
        while trainer.done < trainer.total:
            trainer.step()
            progress.update(trainer.done)
            if time.monotonic() - saved > SAVE_PERIOD:
                try:
                    _store(database, key, trainer)
                except BusyError as error:  # Nobody needs it yet, and the next time is soon.
                    progress.tell(f"what was done is not stored yet: {error}")
                saved = time.monotonic()
    except KeyboardInterrupt:
        try:
            _store(database, key, trainer)
            progress.tell(
                f"interrupted; {trainer.done} of {trainer.total} views are stored, from which the "
                "next training goes on"
            )
        except BusyError as error:
            progress.tell(f"interrupted; what was done last is not stored: {error}")
        raise


def _store(database: Database, key: str, trainer: Trainer) -> None:
    with database.transaction():
        database.models.set_state(key, trainer.done, trainer.state())


def _model(task: Task, key: str, data: bytes) -> Model:
    return Model(task.object.id, task.method.name, task.parameters, key, data)


def title_of(one: Object, method: Method) -> str:
    """Returns what the training of an object by a method is called."""
    return f"{one.name}: {method.name}"


def task_of(
    database: Database, one: Object, method: Method, given: Mapping[str, Any]
) -> Optional[Task]:
    """Returns the training of an object, or None if it has nothing to learn it by.

    Raises:
        ValueError: A parameter cannot be.
    """
    observes = isinstance(method, ObservingMethod)
    observed = database.observations.digest(one.id) if observes else ""
    mesh = None if observed else database.meshes.entry(one.id)
    if mesh is None and not observed:
        return None
    return Task(one, mesh, observed, method, method.complete(given))
