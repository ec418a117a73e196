"""Several instances at once, saved states, reset, logging."""

import threading
import unittest
from ctypes import byref, c_char_p, c_size_t, c_void_p, create_string_buffer

from fmpy.fmi2 import fmi2CoSimulation, fmi2Error, fmi2ModelExchange, fmi2OK
from fmu_support import Failed, Instance, fmu, guid_of, lighter, model_exchange, resources

# Sizes of steps [s], in turn.
STEPS = (0.01, 1e-4, 0.05, 0.003)


def start_values(number: int) -> dict[str, float]:
    """Each instance drives differently."""
    speed = 2.0 + 0.7 * (number % 7)
    return {
        "terrain": 1 + number % 4,
        "omega_left": speed,
        "omega_right": speed - 1.5 + 0.3 * (number % 5),
        "initial.x": float(number),
    }


def advance(instance: Instance, index: int) -> list[float]:
    """One step of a drive, and everything it gives."""
    instance.set_input_derivatives((0.5, -0.4))
    instance.step(STEPS[index % len(STEPS)])
    return instance.outputs()


def drive(number: int, steps: int = 40) -> list[list[float]]:
    """A whole drive of an instance of its own."""
    with Instance().start(start_values(number)) as instance:
        return [advance(instance, index) for index in range(steps)]


class ManyInstances(unittest.TestCase):
    """Instances do not know of each other."""

    COUNT = 24

    def setUp(self) -> None:
        self.serial = [drive(number) for number in range(self.COUNT)]
        self.assertEqual(len({str(outputs) for outputs in self.serial}), self.COUNT)

    def test_taking_turns_they_do_as_alone(self) -> None:
        instances = [Instance().start(start_values(number)) for number in range(self.COUNT)]
        for index in range(40):
            for number, instance in enumerate(instances):
                self.assertEqual(advance(instance, index), self.serial[number][index])
        for instance in instances:
            instance.free()

    def test_in_threads_they_do_as_alone(self) -> None:
        results: dict[int, list[list[float]]] = {}
        begin = threading.Barrier(self.COUNT)

        def work(number: int) -> None:
            begin.wait()
            results[number] = drive(number)

        threads = [threading.Thread(target=work, args=(n,)) for n in range(self.COUNT)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual([results[number] for number in range(self.COUNT)], self.serial)

    def test_both_interfaces_live_side_by_side(self) -> None:
        with model_exchange(start_values(0)) as exchange, Instance() as stepped:
            stepped.start(start_values(0))
            exchange.set_states([9.0, 8.0, 7.0, 1.0, 0.1, 0.2])
            for index in range(5):
                self.assertEqual(advance(stepped, index), self.serial[0][index])
                exchange.derivatives()

    def test_vehicles_live_side_by_side(self) -> None:
        folder = resources(lighter)
        own = {"guid": guid_of(folder), "resources": folder.as_uri()}
        with Instance(**own).start(start_values(0)) as light, Instance() as other:
            other.start(start_values(0))
            for index in range(5):
                advance_light = light.step(STEPS[index % len(STEPS)])
                self.assertIsNone(advance_light)
                self.assertEqual(advance(other, index), self.serial[0][index])
            # A row less, so the wheels from 7 on are not there.
            with self.assertRaisesRegex(Failed, "there is no variable"):
                light.get(["wheel[7].load"])


class States(unittest.TestCase):
    """Saved, restored and serialized states."""

    def setUp(self) -> None:
        self.instance = Instance().start(start_values(1))
        self.addCleanup(self.instance.free)
        for index in range(10):
            advance(self.instance, index)

    def test_an_instance_goes_on_from_a_saved_state(self) -> None:
        saved, time = self.instance.save(), self.instance.time
        expected = [advance(self.instance, index) for index in range(20)]
        for _ in range(2):
            self.instance.restore(saved)
            self.instance.time = time
            self.assertEqual([advance(self.instance, i) for i in range(20)], expected)
        self.instance.free_state(saved)
        self.assertIsNone(saved.value)
        self.instance.free_state(saved)

    def test_input_derivatives_are_part_of_the_state(self) -> None:
        self.instance.set_input_derivatives((1.0, 1.0))
        saved, time = self.instance.save(), self.instance.time
        data = self.instance.serialize()
        self.instance.step(0.1)
        expected = self.instance.outputs()
        for state in (saved, self.instance.deserialize(data)):
            self.instance.restore(state)
            self.instance.free_state(state)
            self.instance.time = time
            self.instance.step(0.1)
            self.assertEqual(self.instance.outputs(), expected)

    def test_a_state_fits_another_instance_in_any_mode(self) -> None:
        saved, time = self.instance.save(), self.instance.time
        expected = [advance(self.instance, index) for index in range(5)]
        fresh, started = Instance(), Instance().start(start_values(2))
        failed = Instance().start({"omega_left": 1.0})
        failed.set({"omega_left": 1e300})
        with self.assertRaises(Failed):
            failed.get(["a_x"])
        for other in (fresh, started, failed):
            with other:
                other.restore(saved)
                other.time = time
                self.assertEqual([advance(other, index) for index in range(5)], expected)
        self.instance.free_state(saved)

    def test_a_state_survives_as_bytes(self) -> None:
        data, time = self.instance.serialize(), self.instance.time
        self.assertEqual(self.instance.serialize(), data)
        expected = [advance(self.instance, index) for index in range(5)]
        with Instance() as other:
            state = other.deserialize(data)
            other.restore(state)
            other.free_state(state)
            other.time = time
            self.assertEqual(other.serialize(), data)
            self.assertEqual([advance(other, index) for index in range(5)], expected)

    def test_a_state_is_overwritten_in_place(self) -> None:
        saved = self.instance.save()
        address, time = saved.value, self.instance.time
        advance(self.instance, 0)
        self.assertEqual(self.instance.call("GetFMUstate", byref(saved)), fmi2OK)
        self.assertEqual(saved.value, address)
        later = self.instance.outputs()
        data = self.instance.serialize()
        advance(self.instance, 1)
        self.instance.restore(saved)
        self.assertEqual(self.instance.outputs(), later)
        self.instance.do("DeSerializeFMUstate", data, c_size_t(len(data)), byref(saved))
        self.assertEqual(saved.value, address)
        self.assertGreater(self.instance.time, time)
        self.instance.free_state(saved)

    def test_a_place_for_a_state_may_hold_anything(self) -> None:
        data = self.instance.serialize()
        for function, arguments in (
            ("GetFMUstate", ()),
            ("DeSerializeFMUstate", (data, c_size_t(len(data)))),
        ):
            place = c_void_p(int.from_bytes(b"\xaa" * 8))
            self.instance.do(function, *arguments, byref(place))
            self.instance.restore(place)
            self.assertEqual(self.instance.serialize(), data)
            self.instance.free_state(place)

    def test_a_state_that_is_freed_is_none_any_more(self) -> None:
        saved = self.instance.save()
        copy = c_void_p(saved.value)
        self.instance.free_state(saved)
        for function, argument in (
            ("SetFMUstate", copy),
            ("SerializedFMUstateSize", copy),
            ("FreeFMUstate", byref(copy)),
        ):
            status = self.instance.call(function, argument, byref(c_size_t()))
            self.assertEqual(status, fmi2Error)
            self.assertIn("this is no saved state, or it has been freed", self.instance.messages[-1].text)

    def test_states_are_saved_in_every_mode(self) -> None:
        with Instance() as instance:
            data = instance.serialize()
            instance.set({"terrain": 1, "vehicle.mass": 333.0})
            instance.setup()
            instance.do("EnterInitializationMode")
            saved = instance.save()
            state = instance.deserialize(data)
            instance.restore(state)
            self.assertNotEqual(instance.call("ExitInitializationMode"), fmi2OK)
            instance.restore(saved)
            self.assertEqual(instance.get(["vehicle.mass"]), [333.0])
            instance.do("ExitInitializationMode")
            instance.do("Terminate")
            instance.free_state(state)
            instance.free_state(saved)

    def test_bytes_of_something_else_are_refused(self) -> None:
        data = self.instance.serialize()
        middle = len(data) // 2
        changed = [bytearray(data) for _ in range(4)]
        changed[0][middle] ^= 1
        changed[1][-1] ^= 0x80
        changed[2][50] ^= 0x10
        changed[3][44:] = b"\xff" * (len(data) - 44)
        folder = resources(lighter)
        other = {"guid": guid_of(folder), "resources": folder.as_uri()}
        with Instance(**other).start() as light:
            foreign = light.serialize()
        for wrong, reason in (
            (b"", "are no state of this FMU"),
            (b"ugvstat", "are no state of this FMU"),
            (bytes(1000), "are no state of this FMU"),
            (b"rubbish " * 100, "are no state of this FMU"),
            (data[:20], "another FMU, or of another version"),
            (data[:44], "an incomplete or damaged state"),
            (data[:100], "an incomplete or damaged state"),
            (data[:-8], "an incomplete or damaged state"),
            (data[:-1], "an incomplete or damaged state"),
            (data + b"\0", "an incomplete or damaged state"),
            (data + data, "an incomplete or damaged state"),
            *((bytes(each), "an incomplete or damaged state") for each in changed),
            (foreign, "another FMU, or of another version"),
        ):
            with self.subTest(size=len(wrong)), self.assertRaisesRegex(Failed, reason):
                self.instance.deserialize(wrong)

    def test_states_of_the_other_interface_or_another_vehicle_are_refused(self) -> None:
        folder = resources(lighter)
        saved, data = self.instance.save(), self.instance.serialize()
        light = Instance(guid=guid_of(folder), resources=folder.as_uri())
        with model_exchange() as exchange, light:
            bytes_state = exchange.deserialize(data)
            for state in (saved, bytes_state):
                with self.assertRaisesRegex(Failed, "the other interface"):
                    exchange.restore(state)
            with self.assertRaisesRegex(Failed, "another vehicle"):
                light.restore(saved)
            exchange.free_state(bytes_state)
            back = exchange.save()
            with self.assertRaisesRegex(Failed, "the other interface"):
                self.instance.restore(back)
            exchange.free_state(back)
        self.instance.free_state(saved)

    def test_too_small_a_buffer_is_refused(self) -> None:
        saved, size = self.instance.save(), c_size_t()
        self.instance.do("SerializedFMUstateSize", saved, byref(size))
        buffer = create_string_buffer(size.value)
        short = c_size_t(size.value - 1)
        self.assertEqual(self.instance.call("SerializeFMUstate", saved, buffer, short), fmi2Error)
        self.assertEqual(buffer.raw, bytes(size.value))
        self.assertIn(f"{size.value} bytes are needed", self.instance.messages[-1].text)
        self.instance.free_state(saved)


class Reset(unittest.TestCase):
    """fmi2Reset leaves nothing of what was before."""

    def test_a_reset_instance_is_like_a_new_one(self) -> None:
        expected = drive(3, 5)
        with Instance() as instance:
            instance.do("Reset")
            for number in (1, 2):
                instance.start(start_values(number) | {"vehicle.mass": 300.0})
                instance.set_input_derivatives((9.0, 9.0))
                instance.step(0.1)
                instance.set_input_derivatives((9.0, 9.0))
                instance.do("Reset")
            instance.start(start_values(3))
            self.assertEqual([advance(instance, index) for index in range(5)], expected)


class Logging(unittest.TestCase):
    """What reaches the importer's logger."""

    def test_the_environment_and_the_name_come_back(self) -> None:
        with Instance(environment=0x1234, name="Größe 1") as instance:
            self.assertEqual(instance.call("Terminate"), fmi2Error)
            (message,) = instance.messages
            self.assertEqual(message[:4], (0x1234, "Größe 1", fmi2Error, "logStatusError"))
            self.assertIn("fmi2Terminate is not allowed before initialization", message.text)

    def test_events_are_reported_when_asked_for(self) -> None:
        def events(logging: bool, categories: list[bytes] | None) -> list[str]:
            with Instance(logging=logging).start() as instance:
                if categories is not None:
                    array = (c_char_p * len(categories))(*categories)
                    instance.do("SetDebugLogging", 1, c_size_t(len(categories)), array)
                instance.step(0.1)
                instance.do("Terminate")
                return [message.category for message in instance.messages]

        self.assertEqual(events(False, None), [])
        self.assertEqual(events(True, None), ["logEvents"])
        self.assertEqual(events(False, []), ["logEvents"])
        self.assertEqual(events(False, [b"logEvents"]), ["logEvents"])
        self.assertEqual(events(True, [b"logStatusError"]), [])

    def test_messages_are_safe_as_formats(self) -> None:
        with Instance(resources="file:/%25s%n#r1#") as instance:
            self.assertIsNotNone(instance.handle)
            text = instance.messages[0].text
            self.assertIn("is no folder", text)
            self.assertNotIn("%", text)
            self.assertNotIn("#", text)

    def test_without_a_logger_nothing_is_said(self) -> None:
        library, description = fmu().library, fmu().description
        guid = description.guid.encode()
        for kind in (fmi2CoSimulation, fmi2ModelExchange):
            handle = c_void_p(library.fmi2Instantiate(None, kind, guid, None, None, 0, 1))
            self.assertIsNotNone(handle.value)
            self.assertEqual(library.fmi2Terminate(handle), fmi2Error)
            library.fmi2FreeInstance(handle)


if __name__ == "__main__":
    unittest.main()
