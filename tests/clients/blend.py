"""Runs the plug-in linden-export-blend with what it needs of Blender 5, whose importer keeps coarser levels out of the view layer."""

import io
import runpy
import sys
import types
from pathlib import Path

PLUGIN = Path(__file__).resolve().parents[2] / "exporters/examples/linden-export-blend"


class Things(dict):
    """A collection of Blender's: by name, walked by value."""

    def __iter__(self):
        return iter(list(self.values()))

    def __contains__(self, name):
        return name in self.keys()

    def link(self, thing):
        self[thing.name] = thing
        thing.users_collection.append(self.owner)

    def unlink(self, thing):
        del self[thing.name]
        thing.users_collection.remove(self.owner)


class Collection:
    def __init__(self):
        self.objects = Things()
        self.objects.owner = self
        self.all_objects = self.objects


class Thing:
    def __init__(self, name, parent, collection):
        self.name, self.parent, self.users_collection = name, parent, []
        self.hide_render = self.is_hidden = False
        collection.objects.link(self)

    def hide_set(self, hidden):
        if self.name not in scene.objects:
            raise RuntimeError(f"Error: Object '{self.name}' cannot be hidden because it is not in View Layer 'ViewLayer'!\n")
        self.is_hidden = hidden


def imported(filepath):
    if filepath.endswith("broken.glb"):
        raise RuntimeError("Error: Bad glTF: it ends early\n")
    root = Thing("Oak", None, scene)
    for level, collection, parent in [(0, scene, root), (1, orphans, None), (2, orphans, None)]:
        empty = Thing(f"Oak_LOD{level}", parent, collection)
        things.extend([empty, Thing(f"oak_wood_LOD{level}", empty, collection)])
    things.append(root)


def run(glb):
    sys.argv = [str(PLUGIN), glb, "oak.blend"]
    sys.stdin = io.StringIO("{}")
    runpy.run_path(str(PLUGIN), run_name="__main__")


scene, orphans, things, saved = Collection(), Collection(), [], []
collections = Things(scene=scene, orphans=orphans)
collections.remove = lambda each: None
passes = lambda **_: None  # noqa: E731
sys.modules["bpy"] = types.SimpleNamespace(
    ops=types.SimpleNamespace(
        wm=types.SimpleNamespace(read_factory_settings=passes, save_as_mainfile=lambda filepath, **_: saved.append(filepath)),
        import_scene=types.SimpleNamespace(gltf=imported),
        file=types.SimpleNamespace(pack_all=passes),
    ),
    data=types.SimpleNamespace(
        objects=things,
        collections=collections,
        texts=types.SimpleNamespace(new=lambda name: types.SimpleNamespace(write=lambda text: None)),
    ),
    context=types.SimpleNamespace(
        scene={},
        view_layer=types.SimpleNamespace(
            objects=scene.objects, update=lambda: None, layer_collection=types.SimpleNamespace(collection=scene)
        ),
    ),
)

run("oak.glb")
for thing in things:
    is_coarser = thing.name.endswith(("_LOD1", "_LOD2"))
    assert thing.users_collection == [scene], thing.name
    assert thing.is_hidden == thing.hide_render == is_coarser, thing.name
assert len(saved) == 1

try:
    run("broken.glb")
except SystemExit as end:
    assert end.code == "Blender: Error: Bad glTF: it ends early", end.code
else:
    raise AssertionError("a file that Blender refuses is an error")
