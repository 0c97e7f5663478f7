function table = hertzline_sweep(scene, vary, varargin)
%HERTZLINE_SWEEP  Simulate a grid or a list of points: a column for each quantity.
%   t = HERTZLINE_SWEEP(scene, vary) varies keys of a scene (see HERTZLINE_RUN). VARY is a cell {KEY, VALUES, ...}, where
%   VALUES are numbers, a cell of texts, or a range as text: 'FROM..TO:COUNT', 'FROM..TO:log:COUNT'. The points are
%   a grid, and the last key varies fastest.
%
%   t = HERTZLINE_SWEEP(scene, vary, KEY, VALUE, ..., OPTION, VALUE, ...) changes keys of the scene first, and takes these
%   options:
%     'points'        a list of points in place of a grid: {KEY, VALUES, ...} with equally many values for each key; VARY is {}
%     'sobol'         number of points of Sobol's sequence in the ranges of VARY, which then have no count: '0.01..2:log'
%     'jobs'          threads; by default one for each usable processor. The rows are the same for any number
%     'measure'       outputs beside v_out whose peaks and spectra are measured
%     'quantities'    the numbers that are kept; by default all
%     'band_from_hz'  lower limit of the bands [Hz]; by default half the drive's frequency
%
%   The table t has columns [point x 1]: numbers as double, NaN where there is none, texts as cells.
%     point, status, message      number of the point from 0, 'ok' or a reason, and a sentence
%     chain.preload_n, ...        the keys that vary, section by section; xEnd for `end`
%     peak_v_out_m_per_s, ...     the numbers of HERTZLINE_RUN's summary; an array has a column for each element
%                                 (harmonics_db_1), an output of 'measure' a struct of columns (f_last.thd_r)
%     provenance                  version, scene and plan
%   A point that cannot be simulated is a row with its reason in status and message.
%
%   Errors: 'hertzline:wrongUse' names every fault of the plan before anything runs; 'hertzline:failed'; 'hertzline:notFound'.
%
%   Example: the best thickness of the plate
%     t = hertzline_sweep('paper-vitreous-carbon', {'end.thickness_m', logspace(-4, -2.7, 30)});
%     [peak, k] = max(t.peak_v_out_m_per_s);
%     t.xEnd.thickness_m(k)
%
%   See also HERTZLINE_RUN, HERTZLINE_OPTIMISE.

known = {'points', '--points', 'file'
         'sobol', '--sobol', 'one'
         'jobs', '--jobs', 'one'
         'measure', '--measure', 'joined'
         'quantities', '--quantity', 'joined'
         'band_from_hz', '--band-from', 'one'};
[folder, cleanup] = scratch_folder(); %#ok<ASGLU>
words = scene_words('hertzline_sweep', known, scene, varargin, folder);
file = fullfile(folder, 'sweep.csv');
call_program([{'sweep', '--output', file}, words, vary_words(vary)], known, folder);
table = read_table(file);
end
