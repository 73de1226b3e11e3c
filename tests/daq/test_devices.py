import sys
from types import ModuleType, SimpleNamespace

import pytest
from support.fake_ni import FakeNi
from support.fake_sound import FakeSound

from armodal.daq.devices import find_devices
from armodal.daq.ports import FoundPort

BOARD = FoundPort(path="/dev/ttyACM0", description="Some board")


@pytest.fixture
def networks(tmp_path):
    for name, kind in (("can0", "280"), ("eth0", "1")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "type").write_text(f"{kind}\n")
        (tmp_path / name / "operstate").write_text("up\n")
    return tmp_path


def looked(networks):
    found, missing = find_devices(serial=lambda: (BOARD,), networks=networks)
    return {(d.kind, d.address, d.description) for d in found}, {m.kind: m.message for m in missing}


def test_what_is_there_is_listed_with_its_address(monkeypatch, networks):
    monkeypatch.setitem(sys.modules, "sounddevice", FakeSound().module)
    there = SimpleNamespace(connection_string="daqref://device0", name="Device 0")
    instance = SimpleNamespace(available_devices=[there])
    monkeypatch.setitem(sys.modules, "opendaq", SimpleNamespace(Instance=lambda: instance))
    for name, module in FakeNi().modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setitem(sys.modules, "paho.mqtt.client", ModuleType("client"))
    found, missing = looked(networks)
    assert found == {
        ("serial", "/dev/ttyACM0", "Some board"),
        ("can", "socketcan:can0", "up"),
        ("sound", "0", "Line In, 4 inputs"),
        ("ni", "cDAQ1Mod1", "NI 9234"),
        ("opendaq", "daqref://device0", "Device 0"),
    }
    assert missing == {}


def test_what_is_missing_is_said_with_how_to_get_it(monkeypatch, networks):
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    monkeypatch.setitem(sys.modules, "nidaqmx", None)
    monkeypatch.setitem(sys.modules, "opendaq", None)
    monkeypatch.setitem(sys.modules, "paho.mqtt.client", None)
    found, missing = looked(networks)
    assert {kind for kind, *_ in found} == {"serial", "can"}
    assert "armodal[sound]" in missing["sound"]
    assert "armodal[ni]" in missing["ni"]
    assert "armodal[opendaq]" in missing["opendaq"]
    assert "armodal[mqtt]" in missing["mqtt"]


def test_a_missing_driver_is_said(monkeypatch, networks):
    ni = FakeNi()
    ni.installed = False
    monkeypatch.setitem(sys.modules, "opendaq", None)
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    for name, module in ni.modules.items():
        monkeypatch.setitem(sys.modules, name, module)
    assert "get it from NI" in looked(networks)[1]["ni"]


def test_front_ends_want_a_compiler(monkeypatch, networks):
    monkeypatch.setitem(sys.modules, "opendaq", None)
    monkeypatch.setattr("armodal.daq.devices.is_current", lambda: False)
    monkeypatch.setattr("armodal.daq.devices.compilers", lambda: iter(()))
    assert "install gcc or clang" in looked(networks)[1]["front ends"]
