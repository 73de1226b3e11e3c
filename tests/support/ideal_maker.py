"""Arms of tables as both makers build them, without errors."""

from __future__ import annotations

import numpy as np

from armodal.hil_sim.makers.arms import arm_table
from armodal.hil_sim.makers.belief import urdf_text
from armodal.hil_sim.makers.frame.beams import tube
from armodal.hil_sim.makers.frame.parts import Drive, Parts
from armodal.hil_sim.makers.mujoco.machine import Axis, Place, read_machine
from armodal.hil_sim.makers.shell_points import shell_points

LOSS_S = 1e-3  # damping over stiffness of every drive


class Ideal:
    """A table's arm, its drives `soft` times as stiff as the table's."""

    def __init__(self, name, soft=1.0):
        self.table = arm_table(name)
        self.stiffness = {r.joint: soft * r.stiffness_n_m_per_rad for r in self.table.links}

    def angles(self, posture):
        return np.deg2rad(self.table.postures_deg[posture])

    def by_joint(self, posture):
        names = (row.joint for row in self.table.links)
        return dict(zip(names, self.angles(posture), strict=True))

    def machine(self):
        machine = read_machine(urdf_text(self.table))
        for joint, stiffness in self.stiffness.items():
            body = machine.moved_by(joint)
            body.axes.append(
                Axis(
                    name=joint,
                    direction=body.drive_axis,
                    at_m=np.zeros(3),
                    stiffness=stiffness,
                    damping=LOSS_S * stiffness,
                )
            )
        for point in shell_points(self.table):
            machine.places[point.id] = Place(
                body=point.link, at_m=point.position_m, R_body_sensor=point.R_link_sensor
            )
        return machine

    def parts(self, rigid=1e4):
        """Parts `rigid` times as stiff as the table's shells and drives, in all but the drives."""
        table = self.table
        shells = {"base": table.base_shell} | {row.link: row.shell for row in table.links}
        sheet = {row.joint: row.stiffness_n_m_per_rad for row in table.links}
        return Parts(
            table=table,
            bodies=list(table.inertials()),
            sections={
                name: tube(
                    shell.diameter_m,
                    shell.wall_m,
                    rigid * table.youngs_modulus_pa,
                    table.density_kg_m3,
                )
                for name, shell in shells.items()
            },
            beam_loss=0.0,
            drives={
                joint: Drive(
                    stiffness=stiffness,
                    law=lambda s, stiffness=stiffness: LOSS_S * stiffness * s,
                    tilt=(rigid * sheet[joint],) * 2,
                    shift_n_per_m=100.0 * rigid * sheet[joint],
                    tilt_loss=0.0,
                )
                for joint, stiffness in self.stiffness.items()
            },
            plate=1e13 * np.eye(6),
            plate_loss=0.0,
        )
