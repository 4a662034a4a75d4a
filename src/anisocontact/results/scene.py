"""Surfaces in space drawn by VTK itself: what pyvista draws with takes longer to import."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import vtkmodules.vtkRenderingFreeType
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (both are found by VTK itself)
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkStringArray
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkFiltersHybrid import vtkPolyDataSilhouette
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingAnnotation import vtkCubeAxesActor, vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkLightKit,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkTextActor,
    vtkWindowToImageFilter,
)

from anisocontact.base.array_types import Floats
from anisocontact.results.solids import SHARP

Colour = tuple[float, float, float]

_BLACK: Colour = (0.0, 0.0, 0.0)
#: Angle of the camera before it zooms, degrees.
_VIEW = 30.0
#: Share of the light that comes from everywhere.
_AMBIENT = 0.25
#: How hard PNG files are compressed: more makes them a fifth smaller and takes a quarter longer.
_QUICK = 3
#: Numbers on the y axis of a box from which on those at its ends are left out.
_MANY = 5
#: Share of the length of an axis up to which a place on it is zero.
_NOTHING = 1e-9
#: Height of letters: of the axes for VTK, of the scale of colours and of the heading in pixels.
_OF_AXES, _OF_BAR, _OF_HEADING = 11.0, 20, 24


class Scene:
    """A window without a display; one picture after the other is drawn in it."""

    def __init__(self) -> None:
        self._renderer: Any = vtkRenderer()
        self._renderer.SetBackground(1.0, 1.0, 1.0)
        # what one can look through has one colour, so that its order means nothing
        self._renderer.UseOITOff()
        self._lights: Any = vtkLightKit()
        self._lights.AddLightsToRenderer(self._renderer)
        self._window: Any = vtkRenderWindow()
        self._window.SetOffScreenRendering(1)
        self._window.SetMultiSamples(4)
        self._window.AddRenderer(self._renderer)
        # one for all pictures: it consists of many parts
        self._axes: Any = vtkCubeAxesActor()

    def begin(self, width: int, height: int) -> None:
        """Begin a picture.

        Args:
            width: Its width, pixels.
            height: Its height.
        """
        self._renderer.RemoveAllViewProps()
        self._window.SetSize(width, height)

    def add_coloured(
        self,
        mesh: Any,
        name: str,
        colours: npt.NDArray[np.uint8],
        limits: tuple[float, float],
        shaded: bool,
    ) -> Any:
        """Add a surface with the colours of values at its points.

        Args:
            mesh: The surface, polygons.
            name: Name of the array.
            colours: Scale of colours, (n, 4).
            limits: Values at its ends.
            shaded: Whether light falls on it; else its colours are those of the scale.

        Returns:
            What `add_bar` shows.
        """
        normals: Any = vtkPolyDataNormals()
        normals.SetInputData(mesh)
        normals.SetFeatureAngle(SHARP)
        table: Any = vtkLookupTable()
        to_vtk: Any = numpy_to_vtk
        table.SetTable(to_vtk(np.ascontiguousarray(colours), deep=True))
        table.SetRange(*limits)
        mapper: Any = vtkPolyDataMapper()
        mapper.SetInputConnection(normals.GetOutputPort())
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectColorArray(name)
        mapper.SetLookupTable(table)
        mapper.UseLookupTableScalarRangeOn()
        mapper.InterpolateScalarsBeforeMappingOn()
        shown = self._add(mapper)
        shown.SetLighting(shaded)
        shown.SetAmbient(_AMBIENT if shaded else 0.0)
        return table

    def add_plain(self, mesh: Any, colour: Colour, opacity: float) -> None:
        """Add a surface of one colour."""
        mapper: Any = vtkPolyDataMapper()
        mapper.SetInputData(mesh)
        mapper.ScalarVisibilityOff()
        shown = self._add(mapper)
        shown.SetColor(*colour)
        shown.SetOpacity(opacity)

    def add_lines(self, lines: Any, width: float) -> None:
        """Add black lines."""
        mapper: Any = vtkPolyDataMapper()
        mapper.SetInputData(lines)
        self._add_flat(mapper, _BLACK, width)

    def add_outline(self, mesh: Any, colour: Colour, width: float) -> None:
        """Add the outline of a surface as it is seen."""
        lines: Any = vtkPolyDataSilhouette()
        lines.SetInputData(mesh)
        lines.SetCamera(self._renderer.GetActiveCamera())
        lines.SetEnableFeatureAngle(0)
        mapper: Any = vtkPolyDataMapper()
        mapper.SetInputConnection(lines.GetOutputPort())
        self._add_flat(mapper, colour, width)

    def add_bar(self, table: Any, title: str) -> None:
        """Add a scale of colours beside what is drawn."""
        bar: Any = vtkScalarBarActor()
        bar.SetLookupTable(table)
        bar.SetTitle(title)
        bar.SetNumberOfLabels(5)
        bar.SetLabelFormat("%.3g")
        bar.SetPosition(0.86, 0.2)
        bar.SetWidth(0.06)
        bar.SetHeight(0.6)
        bar.UnconstrainedFontSizeOn()
        for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
            _plain(text, _OF_BAR)
        self._renderer.AddViewProp(bar)

    def add_axes(self, low: Floats, high: Floats, labels: Sequence[int], unit: str) -> None:
        """Add axes along the outer edges of a box.

        Args:
            low: Its lowest corner, (3,).
            high: Its highest corner.
            labels: Number of labels along each axis.
            unit: Unit of lengths.
        """
        axes = self._axes
        axes.SetBounds(np.column_stack([low, high]).reshape(-1).tolist())
        axes.SetCamera(self._renderer.GetActiveCamera())
        axes.SetFlyModeToOuterEdges()
        axes.SetScreenSize(_OF_AXES)
        for i, name in enumerate("XYZ"):
            words: Any = vtkStringArray()
            # seen from aside, numbers at the ends of y would stand on those of x and z
            inner = name == "Y" and labels[2] > 1
            for word in ticks(low[i], high[i], int(labels[i]), inner):
                words.InsertNextValue(word)
            axes.SetAxisLabels(i, words)
            getattr(axes, f"Set{name}Title")(f"{name.lower()} [{unit}]")
            getattr(axes, f"Set{name}AxisMinorTickVisibility")(False)
            getattr(axes, f"Get{name}AxesLinesProperty")().SetColor(*_BLACK)
            axes.GetTitleTextProperty(i).SetColor(*_BLACK)
            axes.GetLabelTextProperty(i).SetColor(*_BLACK)
        self._renderer.AddViewProp(axes)

    def add_heading(self, text: str) -> None:
        """Add a line at the upper edge."""
        heading: Any = vtkTextActor()
        heading.SetInput(text)
        _plain(heading.GetTextProperty(), _OF_HEADING)
        heading.GetTextProperty().SetJustificationToCentered()
        heading.GetTextProperty().SetVerticalJustificationToTop()
        heading.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        heading.SetPosition(0.5, 0.99)
        self._renderer.AddViewProp(heading)

    def look(self, low: Floats, high: Floats, along: Colour, up: Colour, room: float) -> None:
        """Look at a box.

        Args:
            low: Its lowest corner, (3,).
            high: Its highest corner.
            along: Direction from the box to who looks at it.
            up: What is up in the picture.
            room: Size of the box in the picture, over all of it.
        """
        camera = self._renderer.GetActiveCamera()
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetPosition(*along)
        camera.SetViewUp(*up)
        camera.SetViewAngle(_VIEW)
        self._renderer.ResetCamera(np.column_stack([low, high]).reshape(-1).tolist())
        camera.Zoom(room)

    def render(self) -> None:
        """Draw what was added."""
        self._window.Render()

    def write(self, path: str) -> None:
        """Draw what was added into a PNG.

        Raises:
            OSError: It cannot be written, of which VTK would not say a word.
        """
        self.render()
        image: Any = vtkWindowToImageFilter()
        image.SetInput(self._window)
        image.ReadFrontBufferOff()
        image.ShouldRerenderOff()
        writer: Any = vtkPNGWriter()
        writer.SetInputConnection(image.GetOutputPort())
        writer.SetCompressionLevel(_QUICK)
        writer.WriteToMemoryOn()
        writer.Write()
        Path(path).write_bytes(memoryview(writer.GetResult()))

    def _add_flat(self, mapper: Any, colour: Colour, width: float) -> None:
        """Add lines in one colour whatever light there is."""
        mapper.ScalarVisibilityOff()
        shown = self._add(mapper)
        shown.SetColor(*colour)
        shown.SetLineWidth(width)
        shown.LightingOff()

    def _add(self, mapper: Any) -> Any:
        """Add what a mapper draws; how it looks."""
        actor: Any = vtkActor()
        actor.SetMapper(mapper)
        self._renderer.AddActor(actor)
        return actor.GetProperty()


def ticks(low: float, high: float, count: int, inner: bool = False) -> list[str]:
    """What stands at places of an axis: zero has no sign, and no rounding.

    Args:
        low: Where it begins.
        high: Where it ends.
        count: How many places, both ends among them.
        inner: Whether its ends are left out where there are enough numbers between them.

    Example:
        >>> ticks(-20.0, -0.0, 3), ticks(-0.3, 0.1, 5, inner=True)
        (['-20', '-10', '0'], ['', '-0.2', '-0.1', '0', ''])
    """
    places = np.linspace(low, high, count)
    words = [f"{0.0 if abs(v) < _NOTHING * (high - low) else v:.6g}" for v in places]
    return ["", *words[1:-1], ""] if inner and count >= _MANY else words


def _plain(text: Any, size: int) -> None:
    """Black letters without ornament, of a size in pixels."""
    text.SetColor(*_BLACK)
    text.SetFontSize(size)
    text.ItalicOff()
    text.BoldOff()
    text.ShadowOff()
