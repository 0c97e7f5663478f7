function [columns, about] = read_npy(file)
%READ_NPY  Reads a recording or spectra of the program: a struct of columns, and its description.
%   A field is an output with its unit, as v_chain_m_per_s, and has a column for each sphere, contact or element. The format is
%   https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html: a structured array, then the description in JSON.
handle = fopen(file, 'r', 'ieee-le');
if handle < 0
    error('hertzline:failed', '%s: cannot be read', file);
end
cleanup = onCleanup(@() fclose(handle)); %#ok<NASGU>
head = header(handle);
fields = regexp(head, '\(''([^'']*)'', ''<f([48])''\)', 'tokens');
rows = str2double(regexp(head, '''shape'': \((\d+)', 'tokens', 'once'));
widths = cellfun(@(field) str2double(field{2}), fields);
bytes = fread(handle, [sum(widths), rows], '*uint8');
header(handle);
about = decode_json(native2unicode(fread(handle, Inf, '*uint8')', 'UTF-8'));

types = {'single', 'double'};
ends = cumsum(widths);
names = cellfun(@(field) field{1}, fields, 'UniformOutput', false);
outputs = outputs_of(names, about.columns);
for name = unique(outputs, 'stable')
    chosen = find(strcmp(outputs, name{1}));
    parts = cell(1, numel(chosen));
    for n = 1:numel(chosen)
        k = chosen(n);
        parts{n} = typecast(reshape(bytes(ends(k) - widths(k) + 1 : ends(k), :), [], 1), types{widths(k) / 4});
    end
    columns.(name{1}) = [parts{:}];
end
end

function text = header(handle)
start = fread(handle, 8, 'uint8');
sizes = {'uint16', 'uint32'};
text = fread(handle, fread(handle, 1, sizes{1 + (start(7) > 1)}), '*char')';
end

function outputs = outputs_of(names, described)
% The columns v1_m_per_s, v2_m_per_s of the output v_chain are both v_chain_m_per_s. Times are not described.
outputs = names;
known = cellfun(@(column) column{1}, described, 'UniformOutput', false);
for k = 1:numel(names)
    column = described(strcmp(known, names{k}));
    if ~isempty(column)
        outputs{k} = [column{1}{2} '_' strrep(lower(column{1}{3}), '/', '_per_')];
    end
end
end
