# SPDX-License-Identifier: Apache-2.0
"""Ways to tamper with everything that is judged beside the pins. Each changes the files of a case in a folder of its own.

The case at rest has pictures of its sheet as files; the moving one has its machine, drawing and calibrations beside the scenario.
As for pins, `consistent` says why a PASS with other digests is right.
"""
import os
import re
import shutil

import png

PICTURES = "pictures"
EDITS = []


class FileEdit:
    def __init__(self, name, kind, case, what, apply, consistent, quick):
        self.name, self.kind, self.case, self.what, self.apply = name, kind, case, what, apply
        self.consistent, self.unread, self.quick = consistent, "", quick

    def reason(self, _):
        """Why a PASS is right; empty: it is not."""
        return self.consistent


def edit(kind, what, case="", consistent="", quick=False):
    case = case or ("photographed" if kind == "pictures" else "moving")

    def note(apply):
        EDITS.append(FileEdit(apply.__name__.replace("_", "-"), kind, case, what, apply, consistent, quick))
        return apply
    return note


def read(folder, name):
    with open(os.path.join(folder, name), encoding="utf-8") as file:
        return file.read()


def write(folder, name, text):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def replaced(folder, name, pattern, new):
    """Replaces the first match, which has to be there; `new` may be a function of the match."""
    text, count = re.subn(pattern, new, read(folder, name), count=1, flags=re.MULTILINE)
    if count != 1:
        raise ValueError(f"{name} has no {pattern}")
    write(folder, name, text)


def scaled(factor):
    """For replaced(): the number in the second group times a factor."""
    return lambda match: f"{match[1]}{float(match[2]) * factor:.12g}"


# --- Pictures of the kerf


def picture(folder, number):
    """Path of a picture in the order of the list."""
    names = re.findall(r"file: ([^,]+),", read(folder, f"{PICTURES}/tiles.yaml"))
    return os.path.join(folder, PICTURES, names[number])


def content(path):
    with open(path, "rb") as file:
        return file.read()


def put(path, data):
    with open(path, "wb") as file:
        file.write(data)


def retouched(folder, number, change):
    image = png.Picture(content(picture(folder, number)))
    change(image)
    put(picture(folder, number), image.png())


def entries(folder):
    """Lines of the list before its entries, and these."""
    lines = read(folder, f"{PICTURES}/tiles.yaml").splitlines()
    begin = lines.index("tiles:") + 1
    return lines[:begin], lines[begin:]


def list_again(folder, head, lines):
    write(folder, f"{PICTURES}/tiles.yaml", "\n".join(head + lines) + "\n")


@edit("pictures", "two pictures exchanged")
def pictures_swapped(folder):
    first, second = content(picture(folder, 0)), content(picture(folder, 1))
    put(picture(folder, 0), second)
    put(picture(folder, 1), first)


@edit("pictures", "the places of two pictures exchanged in the list")
def places_swapped(folder):
    head, lines = entries(folder)
    places = [re.search(r"p_TV_mm: .*", line)[0] for line in lines]
    lines[0] = lines[0].replace(places[0], places[1])
    lines[1] = lines[1].replace(places[1], places[0])
    list_again(folder, head, lines)


@edit("pictures", "the pictures of a bad release's sheet")
def sheet_of_bad_release(folder):
    other_sheet(folder, "bad")


@edit("pictures", "the pictures of another good sheet of the same job",
      consistent="A good sheet: nothing in a picture says which one it is. The digest binds the pictures that were judged.")
def sheet_of_good_release(folder):
    other_sheet(folder, "other")


def other_sheet(folder, which):
    shutil.rmtree(os.path.join(folder, PICTURES))
    shutil.copytree(os.path.join(folder, f"{PICTURES}-{which}"), os.path.join(folder, PICTURES))


@edit("pictures", "one picture of a bad release's sheet among the good ones")
def picture_of_bad_release(folder):
    bad = picture(folder, 0).replace(PICTURES, f"{PICTURES}-bad", 1)
    shutil.copy(bad, picture(folder, 0))


@edit("pictures", "a picture deleted", quick=True)
def picture_out(folder):
    os.remove(picture(folder, 0))


@edit("pictures", "a picture taken out of the list")
def entry_out(folder):
    head, lines = entries(folder)
    list_again(folder, head, lines[1:])


@edit("pictures", "a picture twice in the list")
def entry_twice(folder):
    head, lines = entries(folder)
    list_again(folder, head, lines + lines[:1])


def moved(folder, mm):
    replaced(folder, f"{PICTURES}/tiles.yaml", r"(p_TV_mm: \[)([^,]+)", lambda m: f"{m[1]}{float(m[2]) + mm:.17g}")


@edit("pictures", "the place of a picture moved by 0.2 mm in the list")
def place_moved_200_um(folder):
    moved(folder, 0.2)


@edit("pictures", "the place of a picture moved by 10 um in the list",
      consistent="As far as the table's own uncertainty, a fifth of the limit of the path.")
def place_moved_10_um(folder):
    moved(folder, 0.01)


@edit("pictures", "a picture said to be of another unit")
def unit_other(folder):
    replaced(folder, f"{PICTURES}/tiles.yaml", "unit: 0", "unit: 1")


@edit("pictures", "a picture cut off in the middle of the file")
def picture_cut_off(folder):
    data = content(picture(folder, 0))
    put(picture(folder, 0), data[:len(data) // 2])


@edit("pictures", "a picture with a row less")
def picture_smaller(folder):
    def change(image):
        image.rows.pop()
        image.header = image.header[:4] + (image.height - 1).to_bytes(4, "big") + image.header[8:]
    retouched(folder, 0, change)


@edit("pictures", "a picture mirrored")
def picture_mirrored(folder):
    def change(image):
        step = image.step
        for row in image.rows:
            for byte in range(step):
                row[byte::step] = row[byte::step][::-1]
    retouched(folder, 0, change)


@edit("pictures", "a picture painted white")
def picture_white(folder):
    def change(image):
        for row in image.rows:
            row[:] = b"\xff" * len(row)
    retouched(folder, 0, change)


def painted(folder, begin, end):
    """Paints a picture's rows, as shares of its height, with the grey of the board in its middle row."""
    def change(image):
        step = image.step
        grey = sorted(image.rows[image.height // 2][::step])[image.width // 2]
        for row in image.rows[int(begin * image.height):int(end * image.height)]:
            row[:] = bytes([grey] + [0] * (step - 1)) * image.width
    retouched(folder, 0, change)


@edit("pictures", "the board's grey over a part of a picture, over kerfs that no other picture shows", quick=True)
def picture_painted(folder):
    painted(folder, 0.7, 0.85)


@edit("pictures", "the board's grey over a part of a picture, over a kerf that the other picture shows as well")
def picture_painted_in_overlap(folder):
    painted(folder, 0.0, 0.5)


@edit("pictures", "one pixel of a picture a level brighter",
      consistent="Below the noise of a pixel.")
def pixel_changed(folder):
    def change(image):
        row = image.rows[image.height // 2]
        row[image.step - 1] ^= 1
    retouched(folder, 0, change)


@edit("pictures", "a text beside the pixels in a picture's file",
      consistent="The same pixels; the digest binds the file.")
def picture_with_text(folder):
    put(picture(folder, 0), png.with_text(content(picture(folder, 0)), b"retouched by nobody"))


# --- Calibrations


def calibration(folder, pattern, new):
    replaced(folder, "kerf.camera.yaml", pattern, new)


@edit("calibrations", "the kerf camera's calibration of another machine", quick=True)
def calibration_of_other_machine(folder):
    shutil.copy(os.path.join(folder, "other.kerf.camera.yaml"), os.path.join(folder, "kerf.camera.yaml"))


@edit("calibrations", "the spot camera's calibration for the kerf camera")
def calibration_of_other_camera(folder):
    shutil.copy(os.path.join(folder, "spot.camera.yaml"), os.path.join(folder, "kerf.camera.yaml"))


@edit("calibrations", "the name of the camera changed")
def calibration_named_otherwise(folder):
    calibration(folder, "^camera_id: .*$", "camera_id: 'somebody-elses'")


@edit("calibrations", "the fingerprint of the described camera changed")
def calibration_fingerprint(folder):
    calibration(folder, r"^(described_camera: ')(.)", lambda m: m[1] + ("0" if m[2] != "0" else "1"))


@edit("calibrations", "an older day than a calibration may have")
def calibration_older(folder):
    calibration(folder, "^date: .*$", "date: 2026-01-02")


@edit("calibrations", "a later day than the run's")
def calibration_later(folder):
    calibration(folder, "^date: .*$", "date: 2026-12-24")


@edit("calibrations", "a younger day than its own, within the run's",
      consistent="The file's word is all that there is: the second digest binds it.")
def calibration_younger(folder):
    calibration(folder, "^date: .*$", "date: 2026-11-22")


@edit("calibrations", "the focal length along x 0.2 % larger")
def calibration_scale(folder):
    calibration(folder, r"^(focal_px: \[)([^,]+)", scaled(1.002))


@edit("calibrations", "the focal length along x 0.01 % larger",
      consistent="2 um over half of the label, which the printed marks take out in part.")
def calibration_scale_little(folder):
    calibration(folder, r"^(focal_px: \[)([^,]+)", scaled(1.0001))


@edit("calibrations", "the principal point moved by 50 pixels",
      consistent="It moves marks and kerfs alike, 2 mm on the table; a cut is measured from the printed marks.")
def calibration_centre(folder):
    calibration(folder, r"^(principal_px: \[)([^,]+)", lambda m: f"{m[1]}{float(m[2]) + 50:.12g}")


@edit("calibrations", "the distortion ten times as large")
def calibration_distortion(folder):
    calibration(folder, r"^(distortion: \[)([^,]+)", scaled(10))


@edit("calibrations", "the plane turned by 0.1 rad")
def calibration_plane(folder):
    calibration(folder, r"^(  rotation_vector_rad: \[)([^,]+)", lambda m: f"{m[1]}{float(m[2]) + 0.1:.12g}")


@edit("calibrations", "all but one of its errors taken away: less uncertain than it is",
      consistent="Uncertainty of the calibration is a small part of U here; the second digest binds the file.")
def calibration_too_certain(folder):
    lines = read(folder, "kerf.camera.yaml").splitlines()
    begin = lines.index("error_modes:") + 2
    write(folder, "kerf.camera.yaml", "\n".join(lines[:begin]) + "\n")


@edit("calibrations", "a number taken out")
def calibration_incomplete(folder):
    calibration(folder, r"^rms_px: .*\n", "")


# --- Board, drawing, machine, release, scenario


def scenario(folder, more):
    write(folder, "scenario.yaml", read(folder, "scenario.yaml") + more)


SMALL = "A difference that a good job has room for, and the second digest binds the file."


@edit("case", "board twice as thick",
      consistent="The fluence that cuts it through is told apart from its thickness: the model's board is cut as well.")
def board_thicker(folder):
    scenario(folder, "board: {thickness_mm: 0.5}\n")


@edit("case", "board that takes 1.7 times the energy")
def board_harder(folder):
    scenario(folder, "board: {cut_fluence_j_mm2: 0.85}\n")


@edit("case", "board that takes 2 % more energy", consistent=SMALL)
def board_little_harder(folder):
    scenario(folder, "board: {cut_fluence_j_mm2: 0.51}\n")


@edit("case", "board that lets 0.3 of the light through instead of 0.12",
      consistent="The model's back light shines through it as well, and the kerf is as clear.")
def board_clearer(folder):
    scenario(folder, "board: {transmission: 0.3}\n")


@edit("case", "another drawing", quick=True)
def drawing_other(folder):
    shutil.copy(os.path.join(folder, "other.dxf"), os.path.join(folder, "drawing.dxf"))


@edit("case", "a hole 0.1 mm larger in the drawing")
def drawing_hole(folder):
    replaced(folder, "drawing.dxf", r"(\nCIRCLE\n(?:.*\n)*? 40\n)([0-9.]+)", lambda m: f"{m[1]}{float(m[2]) + 0.1}")


@edit("case", "an entity less in the drawing")
def drawing_entity_out(folder):
    replaced(folder, "drawing.dxf", r"  0\nCIRCLE\n(?:.*\n)*?(?=  0\n)", "")


@edit("case", "a machine with a throw of 510 mm instead of 500")
def machine_throw(folder):
    machine(folder, "optics: {throw_mm: 510}\n")


@edit("case", "a machine with steps 1 % larger")
def machine_steps(folder):
    machine(folder, "galvo_x: {step_urad: 12.625}\n")


@edit("case", "a machine whose encoder counts 1 % less")
def machine_encoder(folder):
    machine(folder, "belt: {encoder: {count_mm: 0.0101}}\n")


@edit("case", "a machine whose zero lies 100 urad off")
def machine_zero(folder):
    machine(folder, "optics: {mirror_y: {zero_urad: 100}}\n")


@edit("case", "a machine with a drive that asks for longer pulses")
def machine_drive(folder):
    machine(folder, "galvo_x: {driver: TB6560}\n")


def machine(folder, more):
    write(folder, "machine.yaml", read(folder, "machine.yaml") + more)


@edit("case", "another release named",
      consistent="A replay judges the pins and not the image: the second digest binds which image the scenario names.")
def release_other(folder):
    scenario(folder, "firmware: {source: native, image: fault-belt-late-native, mcu: native}\n")


@edit("case", "the web 2 % faster")
def web_faster(folder):
    replaced(folder, "scenario.yaml", "^belt: .*$", "belt: {speed_mm_s: 61.2, profile: constant}")


@edit("case", "a registration mark printed 0.3 mm elsewhere",
      consistent="The model prints it where the scenario has it, and the job is cut by the eye mark.")
def mark_elsewhere(folder):
    replaced(folder, "scenario.yaml", r"x_mm: -55, y_mm: -27", "x_mm: -55.3, y_mm: -27")


@edit("case", "one registration mark of the photographed sheet 0.3 mm elsewhere", case="photographed")
def mark_of_photographs_elsewhere(folder):
    replaced(folder, "scenario.yaml", r"x_mm: -52, y_mm: -27", "x_mm: -52.3, y_mm: -27")


@edit("case", "two registration marks of the photographed sheet 0.3 mm elsewhere", case="photographed")
def marks_of_photographs_elsewhere(folder):
    replaced(folder, "scenario.yaml", r"x_mm: -52, y_mm: -27", "x_mm: -52.3, y_mm: -27")
    replaced(folder, "scenario.yaml", r"x_mm: -52, y_mm: 27", "x_mm: -52.3, y_mm: 27")


@edit("case", "another entity of the drawing chosen than the photographed sheet has", case="photographed")
def entity_of_photographs_other(folder):
    replaced(folder, "scenario.yaml", r"1-2,5,8-9", "1-2,4,8-9")


@edit("case", "the photographed board ten times as thick", case="photographed",
      consistent="The kerf camera is telecentric and sees no walls; the second digest binds the file.")
def board_of_photographs_thicker(folder):
    scenario(folder, "board: {thickness_mm: 2.5}\n")


@edit("case", "two units instead of the one that was cut")
def units_two(folder):
    replaced(folder, "scenario.yaml", r"units: 1", "units: 2")


@edit("case", "limits of the path ten times as wide",
      consistent="The line of the verdict says that the limits are wider than the defaults.")
def limits_wide(folder):
    scenario(folder, "checks: {path_mm: 0.5, stillness_mm: 0.5}\n")


@edit("case", "another seed", consistent="Other noise in the pictures of the model; both digests tell.")
def seed_other(folder):
    scenario(folder, "seed: 2\n")


@edit("case", "another solver of the twin", consistent="The reference solver agrees with the fast one; both digests tell.")
def solver_other(folder):
    replaced(folder, "scenario.yaml", "^twin: fast$", "twin: reference")


@edit("case", "a comment in the scenario", consistent="The second digest binds its bytes.")
def scenario_commented(folder):
    scenario(folder, "# nothing\n")
