"""Where importers say that the resources are, and what the FMU reads there."""

import tempfile
import unittest
from pathlib import Path
from urllib.parse import quote

from fmu_support import ANY_GUID, Instance, fmu, guid_of, lighter, refusal, resources, scratch


def load_of_front_wheel(**arguments: str | None) -> float:
    """Something that depends on the resources."""
    with Instance(**arguments) as instance:
        return instance.start().get(["wheel[1].load"])[0]


class Location(unittest.TestCase):
    """Every way of writing the URI that importers are known for."""

    def test_the_resources_are_found_however_they_are_written(self) -> None:
        folder = resources(lighter, "Ressourcen für 100% Lehm, 空")
        guid, path = guid_of(folder), str(folder)
        self.assertNotEqual(guid, fmu().description.guid)
        expected = load_of_front_wheel(guid=guid, resources=folder.as_uri())
        self.assertNotEqual(expected, load_of_front_wheel())
        encoded = quote(path)
        for location in (
            "file://" + encoded,
            "file://" + encoded + "/",
            "file:" + encoded,
            "file:///" + encoded,
            "file:////" + encoded,
            "file://localhost" + encoded,
            "FILE://" + encoded,
            "file://" + "".join(f"%{byte:02x}" if byte != 47 else "/" for byte in path.encode()),
            path,
            path + "/",
        ):
            with self.subTest(location):
                self.assertEqual(load_of_front_wheel(guid=guid, resources=location), expected)

    def test_percent_signs_of_a_plain_path_are_its_own(self) -> None:
        folder = resources(lighter, "100%20")
        self.assertNotEqual(load_of_front_wheel(guid=guid_of(folder), resources=str(folder)), 0.0)

    def test_without_a_folder_or_without_files_the_built_in_values_serve(self) -> None:
        empty = Path(tempfile.mkdtemp(dir=scratch()))
        expected = load_of_front_wheel()
        for location, warns in (
            (None, False),
            ("", False),
            (" ", False),
            (empty.as_uri(), False),
            (str(empty), False),
            ((empty / "missing").as_uri(), True),
            ("file:///etc/hostname", True),
        ):
            with self.subTest(location), Instance(resources=location) as instance:
                self.assertEqual([m.text for m in instance.messages if not warns], [])
                if warns:
                    self.assertIn("is no folder", instance.messages[0].text)
                    self.assertEqual(instance.messages[0].category, "logStatusWarning")
                self.assertEqual(instance.start().get(["wheel[1].load"])[0], expected)

    def test_rubbish_is_refused(self) -> None:
        for location in ("rubbish", "http://host/resources", "file:relative", "../up", "file:"):
            with self.subTest(location):
                self.assertIn("neither a file: URI nor", refusal(resources=location))
        self.assertIn("is on a server", refusal(resources="file://server/share/resources"))
        self.assertIn("is not UTF-8", refusal(resources="file:///%ff%fe"))
        self.assertIn("zero byte", refusal(resources="file:///tmp/%00"))
        # Far too long for a path is no folder.
        with Instance(resources="file:///" + "x" * 100_000) as instance:
            self.assertIn("is no folder", instance.messages[0].text)


class Content(unittest.TestCase):
    """Files of the resources that say something else than they should."""

    def test_a_wrong_file_is_named_with_what_is_wrong(self) -> None:
        for file, content, expected in (
            ("vehicle.json", "{", "resources/vehicle.json: "),
            ("vehicle.json", '{"mass": 1}', "the vehicle has no key"),
            ("terrains.json", "[]", "resources/terrains.json: "),
            ("terrain.json", '{"selected": "mud"}', '"selected" must be one of dry_sand'),
            ("terrain.json", "", '"selected" must be one of dry_sand'),
        ):
            folder = resources(lambda folder: (folder / file).write_text(content))  # noqa: B023
            with self.subTest(file=file, content=content):
                self.assertIn(expected, refusal(resources=folder.as_uri()))

    def test_a_file_that_cannot_be_read_is_named(self) -> None:
        def unreadable(folder: Path) -> None:
            (folder / "vehicle.json").unlink()
            (folder / "vehicle.json").mkdir()

        complaint = refusal(resources=resources(unreadable).as_uri())
        self.assertIn("resources/vehicle.json cannot be read", complaint)


class Guid(unittest.TestCase):
    """A model description and a library that do not belong together."""

    def test_another_guid_is_refused_and_told(self) -> None:
        complaint = refusal(guid=ANY_GUID)
        self.assertIn(ANY_GUID, complaint)
        self.assertIn(fmu().description.guid, complaint)
        self.assertTrue(refusal(guid=""))
        # Resources of another vehicle than the model description was written for.
        self.assertIn("is not", refusal(resources=resources(lighter).as_uri()))

    def test_braces_make_no_difference(self) -> None:
        with Instance(guid="{" + fmu().description.guid + "}") as instance:
            self.assertIsNotNone(instance.handle)

    def test_an_unknown_type_of_fmu_is_refused(self) -> None:
        for kind in (2, 1 << 30):
            self.assertIn(f"there is no FMU type {kind}", refusal(kind=kind))


if __name__ == "__main__":
    unittest.main()
