function values = hertzline_scene(scene, varargin)
%HERTZLINE_SCENE  A scene as a struct with all its keys, section by section.
%   s = HERTZLINE_SCENE(scene) reads a shipped scene by its name, a file (a scene or a recording), or a struct that was
%   changed, which is checked.
%
%   s = HERTZLINE_SCENE(scene, KEY, VALUE, ...) changes keys first: HERTZLINE_SCENE('paper-wall', 'chain.spheres', 7).
%
%   The struct s has a field for each section: drive, chain, xEnd, medium, array, numerics, output, materials. `end` is a
%   keyword of the language, so its section is xEnd, the name that jsondecode gives it. A key is a field of its section, in
%   the SI unit that its name tells: s.xEnd.thickness_m [m]. [] means that the scene does not give it: the program
%   chooses (numerics.step_s) or does without. A list is a column, a list of points a matrix [point x 3], a list of names a cell.
%   With a record (drive.file) s.drive.frequency_hz = [] lets the record's strongest line be the frequency.
%   Names of materials of your own are fields, too (s.materials.clay): letters, digits and _.
%
%   Errors: 'hertzline:wrongUse' names every fault, a line each; 'hertzline:notFound'.
%
%   Example: a thinner plate
%     s = hertzline_scene('paper-vitreous-carbon');
%     s.xEnd.thickness_m = 0.4e-3;
%     r = hertzline_run(s);
%
%   See also HERTZLINE_RUN.

[folder, cleanup] = scratch_folder(); %#ok<ASGLU>
words = scene_words('hertzline_scene', cell(0, 3), scene, varargin, folder);
values = decode_json(call_program([{'scenes', '--unresolved', '--json'}, words], cell(0, 3), folder));
end
