function parts = field_path(key)
%FIELD_PATH  The fields of a key or column: end.thicknesses_m[2] is xEnd, thicknesses_m_2.
parts = strsplit(regexprep(char(key), '\[(\d+)\]', '_$1'), '.');
parts = cellfun(@matlab.lang.makeValidName, parts, 'UniformOutput', false);
end
