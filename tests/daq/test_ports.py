from __future__ import annotations

from types import SimpleNamespace

from armodal.daq.ports import FoundPort, find_ports


def port(device: str, description: str, manufacturer: str | None = None) -> SimpleNamespace:
    return SimpleNamespace(device=device, description=description, manufacturer=manufacturer)


def test_ports_come_with_the_words_of_their_devices_in_order():
    found = find_ports(
        lambda: [port("/dev/ttyACM1", "slcan", "Some Maker"), port("/dev/ttyACM0", "DAQ board")]
    )
    assert found == (
        FoundPort(path="/dev/ttyACM0", description="DAQ board"),
        FoundPort(path="/dev/ttyACM1", description="Some Maker slcan"),
    )


def test_ports_behind_which_nothing_is_are_left_out():
    assert find_ports(lambda: [port("/dev/ttyS0", "n/a")]) == ()
