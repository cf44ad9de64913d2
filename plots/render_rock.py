"""Draws a scanned mesh and the convex body (or the clump of spheres) made of it, side by side at the same scale.

Usage: render_rock.py FOLDER          (reads mesh.stl, body.stl and report.json there, writes rock.png)
       render_rock.py FOLDER clump    (reads mesh.stl, clump.stl, clump.json and report.json, writes rock_clump.png)
Needs Debian's python3-vtk9 and a display (xvfb-run -a).
"""

import json
import math
import os
import sys

import vtk

WIDTH, HEIGHT = 1600, 900


def read_surface(path):
    reader = vtk.vtkSTLReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def principal_axes(surface):
    """Directions of the largest, middle and least spread of the points, and their mean."""
    points = vtk.vtkPoints()
    points.DeepCopy(surface.GetPoints())
    centre, size = [0.0] * 3, [0.0] * 3
    largest, middle, least = [0.0] * 3, [0.0] * 3, [0.0] * 3
    vtk.vtkOBBTree.ComputeOBB(points, centre, largest, middle, least, size)
    axes = []
    for axis in (largest, middle, least):
        length = math.sqrt(sum(c * c for c in axis))
        axes.append([c / length for c in axis])
    return axes


def make_actor(surface, colour, smooth, edges):
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(surface)
    normals.SetFeatureAngle(35)
    normals.SetSplitting(True)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normals.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    look = actor.GetProperty()
    look.SetColor(*colour)
    look.SetInterpolation(vtk.VTK_PHONG if smooth else vtk.VTK_FLAT)
    look.SetAmbient(0.20)
    look.SetDiffuse(0.80)
    look.SetSpecular(0.12)
    look.SetSpecularPower(12)
    actors = [actor]
    if edges:
        # Edges between faces that are not coplanar, as thin dark lines.
        lines = vtk.vtkFeatureEdges()
        clean = vtk.vtkCleanPolyData()
        clean.SetInputData(surface)
        lines.SetInputConnection(clean.GetOutputPort())
        lines.SetFeatureAngle(0.05)
        lines.ColoringOff()
        line_mapper = vtk.vtkPolyDataMapper()
        line_mapper.SetInputConnection(lines.GetOutputPort())
        line_mapper.SetResolveCoincidentTopologyToPolygonOffset()
        line_actor = vtk.vtkActor()
        line_actor.SetMapper(line_mapper)
        line_actor.GetProperty().SetColor(0.10, 0.16, 0.24)
        line_actor.GetProperty().SetLineWidth(1.6)
        line_actor.GetProperty().LightingOff()
        actors.append(line_actor)
    return actors


def add_lights(renderer, right, up, towards):
    """A warm key light from the upper left, cool fills from the right and from below, a rim light from behind."""
    renderer.AutomaticLightCreationOff()
    for amounts, colour, intensity in (
        ((-0.8, 0.9, 0.9), (1.0, 0.97, 0.90), 0.95),
        ((1.0, 0.1, 0.7), (0.80, 0.88, 1.0), 0.40),
        ((-0.2, -1.0, 0.6), (0.92, 0.94, 1.0), 0.30),
        ((0.3, 0.8, -1.0), (1.0, 1.0, 1.0), 0.35),
    ):
        light = vtk.vtkLight()
        light.SetLightTypeToSceneLight()
        light.SetPositional(False)
        light.SetFocalPoint(0, 0, 0)
        light.SetPosition(*[amounts[0] * right[k] + amounts[1] * up[k] + amounts[2] * towards[k] for k in range(3)])
        light.SetColor(*colour)
        light.SetIntensity(intensity)
        renderer.AddLight(light)


def add_text(renderer, text, x, y, size, bold=False, centred=True, colour=(0.12, 0.12, 0.14), valign="top"):
    actor = vtk.vtkTextActor()
    actor.SetInput(text)
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(x, y)
    style = actor.GetTextProperty()
    style.SetFontSize(size)
    style.SetFontFamilyToArial()
    style.SetBold(bold)
    style.SetColor(*colour)
    style.SetLineSpacing(1.2)
    if centred:
        style.SetJustificationToCentered()
    if valign == "top":
        style.SetVerticalJustificationToTop()
    renderer.AddActor2D(actor)


def length_text(metres):
    for unit, name in ((1e3, "km"), (1.0, "m"), (1e-3, "mm"), (1e-6, "um")):
        if metres >= unit or unit == 1e-6:
            return f"{metres / unit:.4g} {name}"


def volume_text(cubic_metres):
    for unit, name in ((1e9, "km\u00b3"), (1.0, "m\u00b3"), (1e-6, "cm\u00b3"), (1e-9, "mm\u00b3"), (1e-18, "\u00b5m\u00b3")):
        if cubic_metres >= unit or unit == 1e-18:
            return f"{cubic_metres / unit:.4g} {name}"


def nice_length(below):
    """The largest of 1, 2, 5 times a power of ten that is not above `below`."""
    power = 10 ** math.floor(math.log10(below))
    return max(factor * power for factor in (1, 2, 5) if factor * power <= below)


def add_scale_bar(renderer, half_height, aspect):
    """A bar at the bottom of a panel; half_height: of the view, m."""
    length = nice_length(0.7 * half_height * aspect)
    width = length / (2 * half_height * aspect)
    y = 0.115
    points = vtk.vtkPoints()
    for x in (0.5 - width / 2, 0.5 + width / 2):
        for dy in (0.0, -0.008, 0.008):
            points.InsertNextPoint(x, y + dy, 0)
    lines = vtk.vtkCellArray()
    for a, b in ((0, 3), (1, 2), (4, 5)):
        lines.InsertNextCell(2)
        lines.InsertCellPoint(a)
        lines.InsertCellPoint(b)
    bar = vtk.vtkPolyData()
    bar.SetPoints(points)
    bar.SetLines(lines)
    system = vtk.vtkCoordinate()
    system.SetCoordinateSystemToNormalizedViewport()
    mapper = vtk.vtkPolyDataMapper2D()
    mapper.SetInputData(bar)
    mapper.SetTransformCoordinate(system)
    actor = vtk.vtkActor2D()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.2, 0.2, 0.22)
    actor.GetProperty().SetLineWidth(2)
    renderer.AddActor2D(actor)
    add_text(renderer, length_text(length), 0.5, y - 0.02, 19, colour=(0.2, 0.2, 0.22))


def captions(report):
    mesh, hull, body = report["mesh"], report["hull"], report["body"]
    about = "about " if mesh["volume_is_estimate"] else ""
    state = "closed" if mesh["closed"] else f"open, {mesh['open_edges']} open edges"
    left = (f"{mesh['triangles']} triangles, {state}\n"
            f"volume {about}{volume_text(mesh['volume_m3'])}")
    if body["reduced"]:
        right = f"{body['vertices']} of {hull['vertices']} hull vertices\n"
        right += f"volume {volume_text(body['contact_volume_m3'])}   full hull {volume_text(hull['volume_m3'])}"
        right += f"   inside only one of the two {100 * body['symmetric_difference']:.2g} %"
    else:
        right = f"all {body['vertices']} hull vertices\nvolume {volume_text(body['contact_volume_m3'])}"
    right += f"\nlongest extent {length_text(body['longest_extent_m'])}"
    return left, right


def clump_caption(fit):
    """Two lines on a fit by spheres: how many, and what they miss."""
    return (f"{fit['spheres']} spheres   inside only one of the two {100 * fit['symmetric_difference']:.2g} %\n"
            f"volume {100 * fit['volume_error']:+.2f} %   surface {100 * fit['area_error']:+.2f} %"
            f"   inertia {100 * fit['inertia_error']:.2g} %")


def main():
    if len(sys.argv) not in (2, 3) or sys.argv[2:] not in ([], ["clump"]):
        sys.exit(__doc__)
    folder, of_clump = sys.argv[1], len(sys.argv) == 3
    with open(os.path.join(folder, "report.json"), encoding="utf-8") as file:
        report = json.load(file)
    mesh = read_surface(os.path.join(folder, "mesh.stl"))
    body = read_surface(os.path.join(folder, "clump.stl" if of_clump else "body.stl"))

    # Looking along the shortest axis, the longest one across, tilted so that depth shows.
    right, up, towards = principal_axes(body)
    if sum(a * b for a, b in zip([right[1] * up[2] - right[2] * up[1], right[2] * up[0] - right[0] * up[2],
                                  right[0] * up[1] - right[1] * up[0]], towards)) < 0:
        towards = [-c for c in towards]
    bounds = [min(a, b) if k % 2 == 0 else max(a, b) for k, (a, b) in enumerate(zip(mesh.GetBounds(), body.GetBounds()))]
    centre = [(bounds[2 * k] + bounds[2 * k + 1]) / 2 for k in range(3)]
    panel_aspect = (WIDTH / 2) / HEIGHT
    # Fits the width of a panel and the space between its text and its bar.
    heights = [sum((p - c) * u for p, c, u in zip(surface.GetPoint(k), centre, up))
               for surface in (mesh, body) for k in range(surface.GetNumberOfPoints())]
    tall = 1.08 * (max(heights) - min(heights))
    half_height = max(0.56 * report["body"]["longest_extent_m"] / panel_aspect, 0.5 * tall / 0.58)

    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(WIDTH, HEIGHT)
    left_text, right_text = captions(report)
    if of_clump:
        with open(os.path.join(folder, "clump.json"), encoding="utf-8") as file:
            right_text = clump_caption(json.load(file))
    panels = ((mesh, (0.72, 0.67, 0.60), True, False, 0.0, "mesh", left_text),
              (body, (0.50, 0.66, 0.82), of_clump, not of_clump, 0.5, "clump" if of_clump else "convex body", right_text))
    for surface, colour, smooth, edges, x, name, text in panels:
        renderer = vtk.vtkRenderer()
        renderer.SetViewport(x, 0, x + 0.5, 1)
        renderer.SetBackground(0.90, 0.91, 0.93)
        renderer.SetBackground2(1, 1, 1)
        renderer.GradientBackgroundOn()
        for actor in make_actor(surface, colour, smooth, edges):
            renderer.AddActor(actor)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*centre)
        camera.SetPosition(*[c + 10 * half_height * t for c, t in zip(centre, towards)])
        camera.SetViewUp(*up)
        camera.Azimuth(-25)
        camera.Elevation(20)
        camera.OrthogonalizeViewUp()
        camera.SetParallelScale(half_height)
        view = [p - c for p, c in zip(camera.GetPosition(), centre)]
        length = math.sqrt(sum(c * c for c in view))
        view = [c / length for c in view]
        view_up = camera.GetViewUp()
        view_right = [view_up[1] * view[2] - view_up[2] * view[1], view_up[2] * view[0] - view_up[0] * view[2],
                      view_up[0] * view[1] - view_up[1] * view[0]]
        add_lights(renderer, view_right, view_up, view)
        renderer.ResetCameraClippingRange()
        add_text(renderer, name, 0.5, 0.905, 28, bold=True)
        add_text(renderer, text, 0.5, 0.855, 19)
        add_scale_bar(renderer, half_height, panel_aspect)
        window.AddRenderer(renderer)

    # A title over both panels.
    title = vtk.vtkRenderer()
    title.SetViewport(0, 0.92, 1, 1)
    title.SetBackground(0.16, 0.19, 0.24)
    add_text(title, f"{os.path.basename(report['path'])}    convexity {report['convexity']:.3f}", 0.5, 0.5, 30, bold=True,
             colour=(1, 1, 1), valign="middle")
    title.GetActors2D().GetLastActor2D().GetTextProperty().SetVerticalJustificationToCentered()
    window.AddRenderer(title)

    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(os.path.join(folder, "rock_clump.png" if of_clump else "rock.png"))
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


if __name__ == "__main__":
    main()
