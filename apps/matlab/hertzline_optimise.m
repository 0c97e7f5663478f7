function found = hertzline_optimise(scene, vary, varargin)
%HERTZLINE_OPTIMISE  Search ranges of keys for the best point within bounds.
%   f = HERTZLINE_OPTIMISE(scene, vary, 'maximise', MEASURE) varies keys of a scene (see HERTZLINE_RUN). VARY is a cell
%   {KEY, RANGE, ...}, where RANGE is a text without a count, 'FROM..TO' or 'FROM..TO:log', or a list: numbers or a cell of texts.
%   MEASURE is a number of HERTZLINE_RUN's summary, as 'occupied_20db_hz'.
%
%   f = HERTZLINE_OPTIMISE(scene, vary, KEY, VALUE, ..., OPTION, VALUE, ...) changes keys of the scene first, and takes these
%   options:
%     'maximise', 'minimise'  one of them
%     'subject_to'            bounds that a point must keep, as {'peak_v_out_m_per_s >= 0.3'}
%     'evaluations'           the most points that are simulated; by default 2000
%     'seed'                  with another seed the search starts from other points; by default 1
%     'jobs'                  threads; by default one for each usable processor. The result is the same for any number
%     'measure'               outputs beside v_out that can be the goal or a bound: 'v_plate.thd_r'
%     'band_from_hz'          lower limit of the bands [Hz]; by default half the drive's frequency
%
%   The result f has these fields:
%     best        the row of the best point, with the names of the table; [] where no point keeps to the bounds
%     best_scene  its scene, a struct of HERTZLINE_SCENE; [] as well
%     table       a row for each evaluation, in their order: the columns of HERTZLINE_SWEEP
%     summary     the numbers of `hertzline optimise --json`: how far to trust the result. Dots of names become `_`
%     warnings    a cell of sentences: the best point lies beside a cliff or at a limit of a range, or no point keeps to the bounds
%
%   Errors: 'hertzline:wrongUse' names every fault of the request before anything runs; 'hertzline:failed'; 'hertzline:notFound'.
%
%   Example: the widest band of a loud device
%     f = hertzline_optimise('paper-vitreous-carbon', {'chain.preload_n', '0.01..2:log'}, 'maximise', 'occupied_20db_hz', ...
%                            'subject_to', {'peak_v_out_m_per_s >= 0.3'}, 'evaluations', 100);
%     f.best.chain.preload_n
%
%   See also HERTZLINE_SWEEP.

known = {'maximise', '--maximise', 'one'
         'minimise', '--minimise', 'one'
         'subject_to', '--subject-to', 'each'
         'evaluations', '--evaluations', 'one'
         'seed', '--seed', 'one'
         'jobs', '--jobs', 'one'
         'measure', '--measure', 'joined'
         'band_from_hz', '--band-from', 'one'};
[folder, cleanup] = scratch_folder(); %#ok<ASGLU>
[words, settings] = scene_words('hertzline_optimise', known, scene, varargin, folder);
file = fullfile(folder, 'search.csv');
command = [{'optimise', '--json', '--output', file}, words, vary_words(vary)];
[text, messages, status] = call_program(command, known, folder);
searched = ~isempty(text);
if searched
    found = struct('best', [], 'best_scene', []);
    found.table = read_table(file);
    found.summary = rmfield(decode_json(text), 'file');
    found.warnings = messages.warnings;
    best = found.table.provenance.search.best_point;
end
if status ~= 0 && ~(searched && isempty(best))  % a search without a point within the bounds is a result
    error('hertzline:failed', '%s', messages.faults);
elseif isempty(best)
    found.warnings{end + 1, 1} = messages.faults;
    return
end
found.best = row_of(found.table, found.table.point == best);
for k = 1:2:numel(vary)
    parts = field_path(vary{k});
    value = getfield(found.best, parts{:});
    settings(end + 1 : end + 2) = {char(vary{k}), value}; %#ok<AGROW>
end
found.best_scene = hertzline_scene(scene, settings{:});
end

function row = row_of(table, chosen)
names = setdiff(fieldnames(table), {'provenance'}, 'stable');
for k = 1:numel(names)
    column = table.(names{k});
    if isstruct(column)
        row.(names{k}) = row_of(column, chosen);
    elseif iscell(column)
        row.(names{k}) = column{chosen};
    else
        row.(names{k}) = column(chosen);
    end
end
end
