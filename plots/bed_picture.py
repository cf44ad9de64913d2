"""Draws the surfaces of a bed and the outline of its vessel with VTK, off the screen."""

import colorsys
import math

import numpy as np
import vtkmodules.vtkInteractionStyle  # noqa: F401  registers what the render window needs
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals, vtkTubeFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader
from vtkmodules.vtkRenderingAnnotation import vtkScalarBarActor
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkLight,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkTextActor,
    vtkWindowToImageFilter,
)

VIEW_AZIMUTH, VIEW_ELEVATION, VIEW_ANGLE = 215.0, 24.0, 24.0  # degrees


def rgb(text):
    return tuple(int(text[k : k + 2], 16) / 255 for k in (1, 3, 5))


def view_direction():
    """Unit vector from the bed to the camera."""
    azimuth, elevation = math.radians(VIEW_AZIMUTH), math.radians(VIEW_ELEVATION)
    return np.array([math.cos(elevation) * math.cos(azimuth), math.cos(elevation) * math.sin(azimuth), math.sin(elevation)])


class Bed:
    """Triangles of the particles with one particle number per triangle."""

    def __init__(self, data):
        self.points = vtk_to_numpy(data.GetPoints().GetData()).astype(float)
        self.triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        arrays = data.GetCellData()
        self.arrays = {arrays.GetArrayName(k): vtk_to_numpy(arrays.GetArray(k))[-len(self.triangles):]
                       for k in range(arrays.GetNumberOfArrays()) if arrays.GetArray(k) is not None}
        identity = self.find("id", "particle", "particle_id")
        _, self.particle = np.unique(self.particles_by_points() if identity is None else identity, return_inverse=True)
        count = np.bincount(self.particle)
        middle = self.points[self.triangles].mean(axis=1)
        self.centre = np.stack([np.bincount(self.particle, middle[:, k]) / count for k in range(3)], axis=1)

    def particles_by_points(self):
        """Without an identity: every particle has its own points, one after the other; a new one starts behind all before."""
        first, last = self.triangles.min(axis=1), np.maximum.accumulate(self.triangles.max(axis=1))
        return np.concatenate([[0], np.cumsum(first[1:] > last[:-1])])

    def find(self, *names):
        for name in names:
            for stored, values in self.arrays.items():
                if stored == name or stored.startswith(name + "_m"):
                    return values
        return None

    def speed(self):
        speed = self.find("speed")
        if speed is not None:
            return speed
        velocity = self.find("velocity", "v")
        return None if velocity is None else np.linalg.norm(velocity, axis=1)

    def keep(self, mask):
        """Only the triangles that the mask names."""
        self.triangles, self.particle = self.triangles[mask], self.particle[mask]
        self.arrays = {name: values[mask] for name, values in self.arrays.items()}

    def polydata(self):
        points = vtkPoints()
        points.SetData(numpy_to_vtk(self.points, deep=True))
        cells = vtkCellArray()
        offsets = np.arange(0, 3 * len(self.triangles) + 1, 3, dtype=np.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                      numpy_to_vtkIdTypeArray(self.triangles.astype(np.int64).ravel(), deep=True))
        data = vtkPolyData()
        data.SetPoints(points)
        data.SetPolys(cells)
        return data


def read_bed(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(path)
    reader.GlobalWarningDisplayOff()
    reader.Update()
    data = reader.GetOutput()
    if data is None or data.GetNumberOfPolys() == 0:
        return None
    return Bed(data)


def colour_table(hues):
    table = vtkLookupTable()
    table.SetNumberOfTableValues(256)
    stops = np.array([rgb(hue) for hue in hues])
    for k in range(256):
        at = k / 255 * (len(stops) - 1)
        low = min(int(at), len(stops) - 2)
        table.SetTableValue(k, *((1 - at + low) * stops[low] + (at - low) * stops[low + 1]), 1)
    table.Build()
    return table


def paint_classes(numbers, palette):
    """A colour per triangle from the palette, a shade lighter or darker for every further round through it."""
    numbers = numbers.astype(np.int64)
    colours = np.empty((int(numbers.max()) + 1, 3), dtype=np.uint8)
    for k in range(len(colours)):
        hue, light, saturation = colorsys.rgb_to_hls(*rgb(palette[k % len(palette)]))
        light = min(0.85, max(0.3, light + 0.04 * ((k // len(palette)) % 3 - 1)))
        colours[k] = [round(255 * c) for c in colorsys.hls_to_rgb(hue, light, saturation)]
    return colours[numbers]


def paint(bed, colour, palette, mapper, data):
    """Colours the triangles; returns the title of the scale, or None for classes."""
    shape = bed.find("shape", "shape_index")
    shapes = 0 if shape is None else len(np.unique(shape))
    if colour == "auto":
        colour = "shape" if 2 <= shapes <= 10 else "id"
    if colour == "shape" and shape is None:
        raise ValueError('the frame holds no array "shape"')
    if colour in ("shape", "id"):
        # Neighbours in number are often neighbours in space: spread them over the palette.
        if colour == "shape":
            number = np.unique(shape, return_inverse=True)[1]
        else:
            number = np.random.default_rng(1).permutation(len(bed.centre))[bed.particle]
        data.GetCellData().SetScalars(numpy_to_vtk(paint_classes(number, palette), deep=True))
        mapper.SetColorModeToDirectScalars()
        return None
    values = bed.speed() if colour == "speed" else 1e3 * bed.centre[bed.particle, 2]
    if values is None:
        raise ValueError('the frame holds no array "speed" or "velocity"')
    data.GetCellData().SetScalars(numpy_to_vtk(values.astype(float), deep=True))
    low, high = float(values.min()), float(values.max())
    mapper.SetLookupTable(colour_table(["#2d3e6e", "#3f7f93", "#79b98c", "#f0d16c", "#d8683c"]))
    mapper.SetScalarRange(low, high if high > low else low + 1)
    return "speed / (m/s)" if colour == "speed" else "height / mm"


def make_actor(data, colour, opacity=1.0):
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*rgb(colour))
    actor.GetProperty().SetOpacity(opacity)
    return actor


def make_polydata(points, lines=(), polygons=()):
    data = vtkPolyData()
    vertices = vtkPoints()
    for p in points:
        vertices.InsertNextPoint(*p)
    data.SetPoints(vertices)
    for cells, set_cells in ((lines, data.SetLines), (polygons, data.SetPolys)):
        array = vtkCellArray()
        for cell in cells:
            array.InsertNextCell(len(cell))
            for k in cell:
                array.InsertCellPoint(k)
        set_cells(array)
    return data


def outline_of(vessel, bed):
    """Corners of the vessel's floor, counter-clockwise, and whether they stand for a circle."""
    kind, value = vessel
    if kind == "cylinder":
        angles = np.linspace(0, 2 * math.pi, 96, endpoint=False)
        return [(value["axis_x"] + value["radius"] * math.cos(a), value["axis_y"] + value["radius"] * math.sin(a))
                for a in angles], True
    if kind == "box":
        lo, hi = (value["lo_x"], value["lo_y"]), (value["hi_x"], value["hi_y"])
    else:
        # No vessel known: a floor under the bed.
        low, high = bed.points.min(axis=0), bed.points.max(axis=0)
        margin = 0.15 * (high - low)[:2].max()
        lo, hi = low[:2] - margin, high[:2] + margin
    return [(lo[0], lo[1]), (hi[0], lo[1]), (hi[0], hi[1]), (lo[0], hi[1])], False


def add_vessel(renderer, vessel, bed):
    """Floor, translucent back wall and rims. Returns the points that the picture must show."""
    corners, round_ = outline_of(vessel, bed)
    floor = vessel[1]["floor"] if not math.isnan(vessel[1]["floor"]) else bed.points[:, 2].min()
    top = floor + 1.08 * (bed.points[:, 2].max() - floor)
    span = max(np.ptp([c[0] for c in corners]), np.ptp([c[1] for c in corners]))
    n = len(corners)
    below = floor - 1e-3 * span
    renderer.AddActor(make_actor(make_polydata([(x, y, below) for x, y in corners], polygons=[range(n)]), "#c3c9d0"))
    if vessel[0] is None:
        return np.array([(x, y, below) for x, y in corners])

    # The wall behind the bed only, so that nothing veils it: its panes that face the camera from inside.
    view = view_direction()
    points = [(x, y, floor) for x, y in corners] + [(x, y, top) for x, y in corners]
    panes = []
    for k in range(n):
        (x0, y0), (x1, y1) = corners[k], corners[(k + 1) % n]
        if view[0] * (y1 - y0) - view[1] * (x1 - x0) < 0:
            panes.append((k, (k + 1) % n, n + (k + 1) % n, n + k))
    wall = make_actor(make_polydata(points, polygons=panes), "#8fa6bd", 0.16)
    wall.GetProperty().LightingOff()
    renderer.AddActor(wall)
    edges = [list(range(n)) + [0], list(range(n, 2 * n)) + [n]]
    if not round_:
        edges += [(k, n + k) for k in range(n)]
    tube = vtkTubeFilter()
    tube.SetInputData(make_polydata(points, lines=edges))
    tube.SetRadius(0.0022 * span)
    tube.SetNumberOfSides(8)
    tube.Update()
    rim = make_actor(tube.GetOutput(), "#6a7885", 0.85)
    rim.GetProperty().LightingOff()
    renderer.AddActor(rim)
    return np.array(points)


def add_lights(renderer, camera, centre, radius):
    """A warm key light from the upper left, a cool fill from the right, a little from behind."""
    right = np.cross(camera.GetDirectionOfProjection(), (0, 0, 1))
    right /= np.linalg.norm(right)
    view, up = view_direction(), np.array([0, 0, 1.0])
    for offset, colour, intensity in (
        (view - 0.75 * right + 0.95 * up, (1, 0.97, 0.93), 0.92),
        (view + 1.2 * right + 0.1 * up, (0.88, 0.93, 1), 0.55),
        (-view + 0.5 * right + 0.9 * up, (1, 1, 1), 0.25),
    ):
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPosition(*(centre + 8 * radius * offset))
        light.SetFocalPoint(*centre)
        light.SetColor(*colour)
        light.SetIntensity(intensity)
        renderer.AddLight(light)


def aim_camera(renderer, points, size):
    """Fills the picture with the points, with a margin. Returns the camera, and middle and radius of what it sees."""
    view = view_direction()
    right = np.cross((0, 0, 1), view)
    right /= np.linalg.norm(right)
    up = np.cross(view, right)
    low, high = points.min(axis=0), points.max(axis=0)
    focus, radius = 0.5 * (low + high), 0.5 * np.linalg.norm(high - low)
    half = 0.9 * math.tan(math.radians(VIEW_ANGLE / 2)) * np.array([size[0] / size[1], 1])

    # Perspective: shifting and moving back change each other; a few rounds settle it.
    distance = 4 * radius
    for _ in range(12):
        offset = points - focus
        depth = np.maximum(distance - offset @ view, 0.1 * radius)
        seen = np.stack([offset @ right, offset @ up], axis=1) / depth[:, None]
        least, most = seen.min(axis=0), seen.max(axis=0)
        shift = 0.5 * (least + most) * distance
        focus = focus + shift[0] * right + shift[1] * up
        distance *= max(0.5 * (most - least) / half)
    camera = renderer.GetActiveCamera()
    camera.SetViewAngle(VIEW_ANGLE)
    camera.SetViewUp(0, 0, 1)
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + distance * view))
    renderer.ResetCameraClippingRange()
    return camera, 0.5 * (low + high), radius


def add_texts(renderer, title, scale, mapper, size):
    text = vtkTextActor()
    text.SetInput(title)
    text.GetTextProperty().SetFontSize(max(10, size[1] // 48))
    text.GetTextProperty().SetColor(0.25, 0.28, 0.32)
    text.SetPosition(size[0] // 60, size[1] // 60)
    renderer.AddActor2D(text)
    if scale is None:
        return
    bar = vtkScalarBarActor()
    bar.SetLookupTable(mapper.GetLookupTable())
    bar.SetTitle(scale + "\n")
    bar.SetNumberOfLabels(5)
    bar.SetLabelFormat("%-#.3g")
    bar.UnconstrainedFontSizeOn()
    for font in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        font.SetFontSize(max(10, size[1] // 50))
        font.SetColor(0.25, 0.28, 0.32)
        font.ShadowOff()
        font.ItalicOff()
        font.BoldOff()
    bar.SetPosition(0.9, 0.25)
    bar.SetWidth(0.075)
    bar.SetHeight(0.5)
    renderer.AddActor2D(bar)


def draw_bed(path, vessel, title, options, out, palette):
    """Writes the picture. Returns a message when that is not possible."""
    bed = read_bed(path)
    if bed is None:
        return f"{path}: no particles in it, or not a VTK PolyData file"

    # Everything in unit size, whatever the bed's: VTK's own tolerances are absolute.
    shrink = 1 / max(np.ptp(bed.points, axis=0).max(), 1e-300)
    axis = bed.centre.mean(axis=0)
    if vessel[0] == "cylinder":
        axis[:2] = vessel[1]["axis_x"], vessel[1]["axis_y"]
    whole = Bed.__new__(Bed)
    whole.points = bed.points * shrink
    if options.cut:
        bed.keep(((bed.centre - axis)[:, :2] @ view_direction()[:2] <= 0)[bed.particle])
        if len(bed.triangles) == 0:
            return "--cut leaves no particle"
    data = bed.polydata()
    mapper = vtkPolyDataMapper()
    try:
        scale = paint(bed, options.color, palette, mapper, data)
    except ValueError as error:
        return f"{path}: {error}"
    data.GetPoints().SetData(numpy_to_vtk(whole.points, deep=True))

    # Sharp edges stay sharp, round surfaces round.
    normals = vtkPolyDataNormals()
    normals.SetInputData(data)
    normals.SetFeatureAngle(32)
    normals.SplittingOn()
    normals.ConsistencyOff()
    mapper.SetInputConnection(normals.GetOutputPort())
    particles = vtkActor()
    particles.SetMapper(mapper)
    particles.GetProperty().SetAmbient(0.22)
    particles.GetProperty().SetDiffuse(0.95)
    particles.GetProperty().SetSpecular(0.12)
    particles.GetProperty().SetSpecularPower(25)

    renderer = vtkRenderer()
    renderer.SetBackground(0.93, 0.945, 0.96)
    renderer.SetBackground2(1, 1, 1)
    renderer.GradientBackgroundOn()
    renderer.AddActor(particles)
    outline = add_vessel(renderer, (vessel[0], {name: value * shrink for name, value in vessel[1].items()}), whole)
    camera, centre, radius = aim_camera(renderer, np.concatenate([outline, whole.points]), options.size)
    add_lights(renderer, camera, centre, radius)
    add_texts(renderer, title, scale, mapper, options.size)
    shade_crevices(renderer, radius)
    return save(renderer, options.size, out)


def shade_crevices(renderer, radius):
    """Ambient occlusion: what makes a heap of equal colours readable."""
    renderer.UseSSAOOn()
    renderer.SetSSAORadius(0.06 * radius)
    renderer.SetSSAOBias(0.003 * radius)
    renderer.SetSSAOKernelSize(64)
    renderer.SSAOBlurOn()
    renderer.UseFXAAOn()


def save(renderer, size, out):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(*size)
    window.AddRenderer(renderer)
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(out)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()
    return None if writer.GetErrorCode() == 0 else f"{out} cannot be written"
