"""Words of other codes for what has another name here."""

from __future__ import annotations

import difflib
from collections.abc import Collection, Iterable

#: Name here -> words of Abaqus, Ansys, CalculiX, FEniCS and the literature for it, in small letters
#: and with one underscore between them.
_SAME = {
    "E": "young youngs young_modulus youngs_modulus young's_modulus elastic_modulus modulus "
    "modulus_of_elasticity emod e_modul",
    "nu": "poisson poissons poisson_ratio poissons_ratio poisson's_ratio prxy nuxy",
    "coefficients": "mu mus muk friction_coefficient coefficient coefficient_of_friction cof fric "
    "static_friction kinetic_friction dynamic_friction mu_s mu_k friction",
    "penalty": "penalty_stiffness penalty_factor normal_stiffness contact_stiffness fkn eps_n "
    "epsilon_n kn",
    "stiffness": "tangential_stiffness stick_stiffness elastic_slip_stiffness shear_stiffness fkt "
    "eps_t epsilon_t kt penalty",
    "density": "rho dens mass_density",
    "expansion": "alpha alpx cte thermal_expansion coefficient_of_thermal_expansion",
    "yield_stress": "sigma_y sigma_0 sigy yield_strength rp02 re",
    "lankford": "r_values r_value r_bar anisotropy",
    "bulk_modulus": "k kappa bulk",
    "tau": "relaxation_times times time_constants",
    "viscoelastic": "prony maxwell",
    "plastic": "j2 von_mises mises elastoplastic",
    "directions": "direction orientation axes texture local_axes",
    "displacement": "boundary bc bcs boundary_condition boundary_conditions dirichlet dirichlet_bc "
    "dirichletbc support supports fix fixed encastre spc disp prescribed_displacement",
    "force": "load loads cload nodal_force point_load concentrated_force concentrated_load",
    "traction": "neumann neumann_bc surface_traction surface_load dload dsload",
    "pressure": "press surface_pressure",
    "body_force": "gravity grav acceleration acel volume_force volume_load self_weight bodyforce",
    "motion": "boundary bc bcs rigid_motion reference_point_displacement",
    "increments": "substeps nsubst n_increments num_increments number_of_increments inc ninc steps "
    "n_steps nsteps time_steps",
    "duration": "time time_period period total_time end_time t_end",
    "step": "steps load_step load_steps loadstep loadsteps stages",
    "material": "materials mat mats mp",
    "contact": "contacts contact_pair contact_pairs interaction interactions surface_interaction",
    "surface": "surfaces rigid_surface rigid_surfaces analytical_surface",
    "rigid": "rigid_body rigid_bodies",
    "mesh": "geometry part parts bodies body grid",
    "slave": "secondary slave_surface secondary_surface contact_surface source",
    "master": "primary main master_surface primary_surface main_surface target target_surface",
    "cells": "elements divisions n_cells ncells subdivisions resolution seeds",
    "cell": "element element_type cell_type eltype",
    "order": "degree element_order polynomial_order",
    "origin": "corner lower position",
    "size": "lengths extent dimensions dims",
    "method": "algorithm formulation enforcement",
    "adjust": "initial_clearance interference_fit shrink",
    "sliding_rule": "slip_rule flow_rule",
    "tie": "ties tied bonded bond bonded_contact glue glued mesh_tying mpc",
    "cyclic": "cyclic_symmetry cyclic_symmetry_model cyclsym cyclic_region rotational_symmetry "
    "rotational_periodicity",
    "sectors": "n number_of_sectors repetitions",
    "cylindrical": "transform csys nrotat polar local_system radial_displacement",
    "symmetry": "xsymm ysymm zsymm symmetry_planes symmetric",
    "elastic_support": "foundation elastic_foundation bedding",
    "until": "event stop_when terminate termination end_on stop_criterion stopping_criterion",
    "smallest_increment": "min_increment minimum_increment minimum_time_increment dtmin",
    "largest_increment": "max_increment maximum_increment maximum_time_increment dtmax",
    "linear-elastic": "elastic linear isotropic linear_elasticity hooke hookean lame",
    "neo-hookean": "neo_hooke neohooke neohookean hyperelastic",
    "st-venant-kirchhoff": "svk saint_venant_kirchhoff st_venant kirchhoff",
    "orthotropic": "coulomb isotropic anisotropic",
    "maximum-dissipation": "associated associative normality return_mapping",
    "augmented": "augmented_lagrangian augmented_lagrange lagrange lagrange_multipliers mortar alm",
    "direct": "lu mumps cholesky",
    "iterative": "gmres cg fgmres krylov",
}

#: Likeness (of difflib) from which a name counts as a slip of another; "bodies" is not "disc".
NEAR = 0.61
_STIFFNESS = "the run chooses it (auto), or contact.normal.penalty says it"
_STRAIN = (
    'the material says it: "linear-elastic" is small strain, "st-venant-kirchhoff" and '
    '"neo-hookean" are finite strain'
)
_STEPS = (
    "loads and supports stand in a step, [[step]], with increments and a duration; "
    "solver.smallest_increment bounds how an increment may be cut"
)
#: Word -> where what it stands for is said here, where it is no key of the same table.
_ELSEWHERE = {
    "gravity": "a step has it: gravity = { z = -9.81 }, with density in the table of each material",
    "density": "the table of the material has it, for gravity; inertia is left out",
    "mu": "friction = { coefficients = ... } of a contact",
    "displacement": 'a step has it: displacement = { "body.group" = { x = ... } }',
    "force": 'a step has it: force = { "body.group" = { x = ... } } on the group, or traction',
    "E": "the table of the material has E and nu",
    "tie": "bodies that are glued together stand in a table [[tie]], with slave and master",
    "nlgeom": _STRAIN,
    "large_strain": _STRAIN,
    "large_deformation": _STRAIN,
    "large_displacement": _STRAIN,
    "finite_strain": _STRAIN,
    "plane_strain": '[idealisation] kind = "plane-strain", for a mesh in the plane',
    "plane_stress": '[idealisation] kind = "plane-stress", for a mesh in the plane',
    "axisymmetric": '[idealisation] kind = "axisymmetric", for a mesh in the plane',
    "thickness": "the table [idealisation] has it, for plane strain and plane stress",
    "time_step": _STEPS,
    "timestep": _STEPS,
    "dt": _STEPS,
    "time_increment": _STEPS,
    "initial_increment": _STEPS,
    "step_size": _STEPS,
    "penalty": _STIFFNESS,
    "coefficients": "the table friction of a contact has them: friction = { coefficients = ... }",
    "d1": "bulk_modulus is 2/D1",
    "thermal": "expansion in the table of a material, and temperature in steps",
    "damping": "inertia is left out, and damping with it; contact laws may be viscous",
    "velocity": "a displacement and the duration of its step; inertia is left out",
    "max_iterations": "solver.options = { snes_max_it = 50 }",
    "max_iter": "solver.options = { snes_max_it = 50 }",
    "maxiter": "solver.options = { snes_max_it = 50 }",
    "tolerance": "solver.options = { snes_rtol = 1e-8 }",
    "rtol": "solver.options = { snes_rtol = 1e-8 }",
}


def meant(word: str, known: Iterable[str]) -> str | None:
    """The known name that a wrong one stands for.

    Args:
        word: What was written.
        known: The names there are.

    Returns:
        What another code calls so, else the only one that goes on from it, else the one that is
        spelt most like it; None if none is near.

    Example:
        >>> meant("youngs_modulus", ["model", "E", "nu"]), meant("ordr", ["cell", "order"])
        ('E', 'order')
        >>> meant("yield", ["E", "yield_stress"]), meant("bodies", ["box", "disc"])
        ('yield_stress', None)
    """
    names = list(known)
    plain = _plain(word)
    for name in names:
        if plain in _SAME.get(name, "").split() or plain == _plain(name):
            return name
    longer = [name for name in names if name.startswith(f"{plain}_")]
    close = longer if len(longer) == 1 else difflib.get_close_matches(word, names, 1, NEAR)
    return close[0] if close else None


def hint(name: str, known: Collection[str], others: str = "there are") -> str:
    """The end of a message: the known name that one of the user's own is spelt like, else all.

    Of the groups of a body, "body.group", those of the same body count where there are some, and
    what is spelt alike is the group.

    Args:
        name: What was written.
        known: The names there are.
        others: What is said in front of all of them.

    Example:
        >>> hint("blok", ["block", "base"]), hint("x", ["block", "base"])
        ("did you mean 'block'?", 'there are: block, base')
        >>> hint("block.front", ["block.left", "block.top", "base.left"])
        'there are: block.left, block.top'
    """
    body, dot, group = name.rpartition(".")
    own = [one for one in known if dot and one.rpartition(".")[0] == body]
    if own:
        near = difflib.get_close_matches(group, [one[len(body) + 1 :] for one in own], n=1)
        near = [f"{body}.{one}" for one in near]
    else:
        near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    return (
        f"did you mean {near[0]!r}?" if near else f"{others}: {', '.join(own or known) or 'none'}"
    )


def elsewhere(word: str) -> str | None:
    """Where what a word stands for is said, if it is no key of the table it was written in.

    Returns:
        A few words; None if nothing is known of it.

    Example:
        >>> elsewhere("rho")
        'the table of the material has it, for gravity; inertia is left out'
    """
    plain = _plain(word)
    if plain in _ELSEWHERE:
        return _ELSEWHERE[plain]
    same = (name for name, words in _SAME.items() if plain in words.split())
    return next((_ELSEWHERE[name] for name in same if name in _ELSEWHERE), None)


def _plain(word: str) -> str:
    return word.strip().lower().replace("-", "_").replace(" ", "_")
