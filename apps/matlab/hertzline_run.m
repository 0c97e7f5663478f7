function result = hertzline_run(scene, varargin)
%HERTZLINE_RUN  Simulate a scene: samples, spectra and the numbers of a summary.
%   r = HERTZLINE_RUN(scene) simulates from 0 to output.duration_s. SCENE is the name of a shipped scene, a file (a scene or
%   a recording), or a struct of HERTZLINE_SCENE.
%
%   r = HERTZLINE_RUN(scene, KEY, VALUE, ...) changes keys of the scene first: a name with a dot is a key, as
%   'chain.preload_n'. Values are in SI units; a text may have its unit, as '0.5 mm'. scenes/README.md has all keys.
%
%   r = HERTZLINE_RUN(scene, ..., OPTION, VALUE, ...) with these options, whose names have no dot:
%     'taps'          outputs to keep, as {'v_out', 'v_chain'}; by default those that `hertzline run -o` saves
%     'measure'       outputs beside v_out whose peaks and spectra are measured
%     'band_from_hz'  bands are looked for from here upward [Hz]; by default half the drive's frequency
%     'save'          files for the samples; their endings choose the formats, as {'x.h5', 'x.sigmf-meta'}
%
%   The result r has double columns, equal to the program's bit for bit:
%     t_s                      time since the start [s], [sample x 1]
%     v_out_m_per_s, ...       an output and its unit: [sample x 1]; of a chain (v_chain, x_chain, f_chain) and of an array
%                              [sample x sphere], [sample x contact] or [sample x element]
%     sample_rate_hz           samples a second [Hz]
%     spectrum                 frequency_hz [line x 1] and the amplitude of each measured output, v_out_m_per_s [line x 1]
%     summary                  the numbers of `hertzline run --json`, under the same names; [] or NaN where there is none
%     warnings                 the program's warnings, a cell of sentences: read them before you trust the numbers
%     provenance               version, resolved scene, integrator, step, estimated error
%
%   Errors: 'hertzline:wrongUse' names every fault, a line each, with the found and the allowed value; 'hertzline:failed' is
%   a run without memory, a motion that becomes unstable, or a file that cannot be written; 'hertzline:notFound'.
%
%   Example: the preload's effect on the last sphere
%     r = hertzline_run('paper-vitreous-carbon', 'chain.preload_n', 0.5, 'taps', {'v_last', 'v_out'});
%     plot(r.t_s, r.v_last_m_per_s), xlabel('t [s]'), ylabel('v [m/s]')
%     r.summary.peak_v_out_m_per_s
%
%   See also HERTZLINE_SCENE, HERTZLINE_SWEEP, HERTZLINE_OPTIMISE, HERTZLINE_LISTEN.

known = {'taps', '--columns', 'joined'
         'measure', '--measure', 'joined'
         'band_from_hz', '--band-from', 'one'
         'save', '--output', 'each'};
[folder, cleanup] = scratch_folder(); %#ok<ASGLU>
words = scene_words('hertzline_run', known, scene, varargin, folder);
samples = fullfile(folder, 'run.npy');
spectrum = fullfile(folder, 'spectrum.npy');
text = call_program([{'run', '--json', '--output', samples, '--spectrum', spectrum}, words], known, folder);

[result, about] = read_npy(samples);
result.sample_rate_hz = about.sample_rate_hz;
result.spectrum = read_npy(spectrum);
summary = decode_json(text);
result.summary = rmfield(summary, {'recordings', 'warnings'});
result.warnings = cell(0, 1);
if ~isempty(summary.warnings)  % MATLAB reads an empty list as a matrix
    result.warnings = reshape(cellstr(summary.warnings), [], 1);
end
result.provenance = about.provenance;
end
