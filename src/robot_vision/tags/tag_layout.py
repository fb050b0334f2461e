"""The tags that the user describes: families, sizes, names, and bundles on rigid bodies."""

import re
from dataclasses import dataclass
from typing import Any, Dict, Iterable, List, NamedTuple

from .. import Bundle, tag_family
from ..common.errors import about
from ..common.plain_text import NAME, brief, is_name
from .bundle_files import MAX_TAG_SIZE, list_of, parse_bundles, require_map
from .tag_ids import parse_ids, require_id


class TagKey(NamedTuple):
    """The family and the id of a tag."""

    family: str
    id: int


class _Tag(NamedTuple):
    size: float  # m
    name: str


@dataclass(frozen=True)
class FamilyBundle:
    """A bundle, and the family of its tags."""

    family: str
    bundle: Bundle


class TagLayout:
    """Sizes and names of tags, in the form of apriltag_ros' parameters.

    Args:
        families: Names separated by commas, or a list. Entries that name no family belong to the
            first one.
        tag_size: The size in m, between the corners, of all tags that are in no list.
        standalone_tags: [{id: 7 | ids: 3,10-19, size: m, name:, family:}, ...]; size, name and
            family may be missing.
        tag_bundles: Bundles as described in bundle_files; each may have a family.

    Raises:
        ValueError: A value is wrong; the message says what is wrong, and where.
    """

    def __init__(
        self, families: Any, tag_size: float, standalone_tags: Any = (), tag_bundles: Any = ()
    ):
        self.families = _families(families)
        self._size = _checked_size(tag_size, "tag_size")
        self._tags: Dict[TagKey, _Tag] = {}
        for index, entry in enumerate(list_of(standalone_tags, "standalone_tags")):
            self._add(entry, f"standalone_tags[{index}]")
        self.bundles = self._read_bundles(tag_bundles)
        self._require_different_names()

    def size(self, tag: TagKey) -> float:
        """Returns the size of a tag in m, between its corners."""
        return self._tags[tag].size if tag in self._tags else self._size

    def frame_id(self, tag: TagKey) -> str:
        """Returns the frame of a tag: its name, tag_<id>, or <family>_<id> for further families."""
        if tag in self._tags and self._tags[tag].name:
            return self._tags[tag].name
        prefix = "tag" if tag.family == self.families[0] else tag.family
        return f"{prefix}_{tag.id}"

    def _add(self, entry: Any, where: str) -> None:
        require_map(entry, where, ("id", "ids", "size", "name", "family"))
        if ("id" in entry) == ("ids" in entry):
            raise ValueError(f"{where} must have either id or ids")
        with about(where):
            family = self._family_of(entry)
            ids = _ids_of(entry, family)
            size = _checked_size(entry.get("size", self._size), "size")
            name = entry.get("name", "")
            if not isinstance(name, str) or (name and not is_name(name)):
                raise ValueError(f"name is {brief(name)}, must be {NAME}")
            if name and len(ids) > 1:
                raise ValueError(f"name is '{name}', but there are {len(ids)} tags")
            for number in ids:
                if TagKey(family, number) in self._tags:
                    raise ValueError(f"tag {number} of {family} is there twice")
                self._tags[TagKey(family, number)] = _Tag(size, name)

    def _read_bundles(self, values: Any) -> List[FamilyBundle]:
        bundles = parse_bundles(values)
        found = []
        for value, bundle in zip(values, bundles):
            with about(f"bundle '{bundle.name}'"):
                family = self._family_of(value)
                for tag in bundle.tags:
                    require_id(tag.id, family)
                    self._require_same_size(TagKey(family, tag.id), tag.size)
            found.append(FamilyBundle(family, bundle))
        return found

    def _require_same_size(self, key: TagKey, size: float) -> None:
        """Checks that a bundle's tag has the same size elsewhere, as it also has its own pose."""
        known = self._tags.setdefault(key, _Tag(size, ""))
        if known.size != size:
            raise ValueError(
                f"tag {key.id} of {key.family} has size {size:g}, elsewhere {known.size:g}"
            )

    def _family_of(self, entry: Dict[str, Any]) -> str:
        family = entry.get("family", self.families[0])
        if family not in self.families:
            known = ", ".join(self.families)
            raise ValueError(f"family is {brief(family)}, must be one of families: {known}")
        return family

    def _require_different_names(self) -> None:
        owners: Dict[str, str] = {}
        named: Iterable[Any] = [
            *((self.frame_id(tag), f"tag {tag.id} of {tag.family}") for tag in self._tags),
            *((one.bundle.name, f"bundle '{one.bundle.name}'") for one in self.bundles),
        ]
        for name, owner in named:
            other = owners.get(name) or self._unnamed_owner(name) or owner
            if other != owner:
                raise ValueError(f"{other} and {owner} have the same transform '{name}'")
            owners[name] = owner

    def _unnamed_owner(self, name: str) -> str:
        """Returns the tag without a name whose frame has this name, or ""."""
        number = name.rpartition("_")[2]
        if not re.fullmatch("[0-9]{1,9}", number):
            return ""
        for tag in (TagKey(family, int(number)) for family in self.families):
            is_named = tag in self._tags and self._tags[tag].name
            if not is_named and tag.id < tag_family(tag.family).ids and self.frame_id(tag) == name:
                return f"tag {tag.id} of {tag.family}"
        return ""


def _families(value: Any) -> List[str]:
    names = value.split(",") if isinstance(value, str) else value
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError(f"families is {brief(value)}, must be names between commas")
    if not names:
        raise ValueError("families is empty, must be at least one")
    names = [name.strip() for name in names]
    for name in names:
        with about("families"):
            tag_family(name)
        if names.count(name) > 1:
            raise ValueError(f"families has '{name}' twice")
    return names


def _ids_of(entry: Dict[str, Any], family: str) -> List[int]:
    if "ids" in entry:
        return parse_ids(str(entry["ids"]), family)
    if type(entry["id"]) is not int:
        raise ValueError(f"id is {brief(entry['id'])}, must be a whole number")
    require_id(entry["id"], family)
    return [entry["id"]]


def _checked_size(value: Any, where: str) -> float:
    if type(value) not in (int, float) or not 0.0 < value <= MAX_TAG_SIZE:
        raise ValueError(
            f"{where} is {brief(value)}, must be above 0 and at most {MAX_TAG_SIZE:g} m"
        )
    return float(value)
